/* The runs of a lesson as sounds to compare: one scale, one length, one speed-up. The stage stays as it is. */
const { lessons, sound } = rub;
const SECONDS = 1.5; // of sound at most
const LIVES = 1500; // at most, of the run whose lives are shortest
const TICKS_PER_LIFE = 60;
const LETTERS = 'ABC';
const made = new Map();

/** Return a column of a run over a sliding distance in um, sampled at even distances. */
function heard(world, column, distance, count) {
  const exact = rub.theory.exact(world);
  const tick = exact.lifeMean / TICKS_PER_LIFE;
  const ticks = Math.ceil(distance / tick) + 2;
  const start = (world.strength * exact.areaMean) / world.stiffness;
  const trace = new rub.Trace(world, new rub.model.Births({ ...world }), tick, ticks, start);
  trace.until(ticks);
  const values = Float32Array.from({ length: count }, (_, i) => trace.at(column, (i * distance) / count));
  const mean = values.reduce((sum, value) => sum + value, 0) / count;
  return values.map((value) => value - mean);
}

/** Return the sounds of runs: samples on one scale, by how much faster they are, and their levels in dB. */
function compare(experiment, rate) {
  const worlds = experiment.runs.map((run) => ({ ...rub.world, ...run.set }));
  const key = JSON.stringify([worlds, experiment.sound, rate]);
  if (made.has(key)) return made.get(key);
  const exact = worlds.map((world) => rub.theory.exact(world));
  const own = Math.min(...exact.map((each) => each.naturalFrequency));
  const factor = sound.FACTORS.find((each) => each * own >= sound.AUDIBLE) ?? sound.FACTORS.at(-1);
  const { speed } = worlds[0];
  const shortest = LIVES * Math.min(...exact.map((each) => each.lifeMean));
  const distance = Math.min(SECONDS * factor * speed, shortest);
  const count = Math.floor((distance / speed / factor) * rate);
  const values = worlds.map((world) => heard(world, experiment.sound, distance, count));
  const peak = Math.max(...values.map((each) => each.reduce((most, value) => Math.max(most, Math.abs(value)), 0)));
  const samples = values.map((each) => each.map((value) => (sound.PEAK * value) / peak));
  const levels = samples.map((each) => 10 * Math.log10(each.reduce((sum, value) => sum + value * value, 0) / count));
  const found = { samples, levels, factor, seconds: count / rate };
  made.set(key, found);
  return found;
}

/** Play a run of the open lesson, or stop it; return in words what is heard. */
function play(experiment, index) {
  if (sound.source) {
    sound.stop();
    return '';
  }
  sound.context ??= new AudioContext();
  const { samples, levels, factor, seconds } = compare(experiment, sound.context.sampleRate);
  sound.start(samples[index]);
  const what = experiment.sound === 'force' ? 'friction force' : 'velocity of the slider';
  const loud = experiment.runs.map((_, i) => `${LETTERS[i]} ${levels[i].toFixed(1)} dB`.replace('-', '−')).join(', ');
  return (
    `${LETTERS[index]}: ${experiment.runs[index].label}. The ${what}, ${factor} times faster, ` +
    `${seconds.toFixed(1)} s, all on one scale: ${loud}.`
  );
}

lessons.sounds = { compare, play, LETTERS };
