/* The ear: what the slider does, as sound, at true speed or scaled, with the mapping in words. */
const { said } = rub.plot;
const LONGEST = 4; // seconds of sound
const PEAK = 0.8;
const HEARD_WORK = 800000; // of a slider that pushes back: a second or so
const AUDIBLE = 200; // Hz to which the slider's own frequency is raised where nothing is chosen
const FACTORS = [1 / 64, 1 / 16, 1 / 4, 1, 2, 4, 8, 16, 32, 64, 128];
const WHAT = { velocity: ['velocity of the slider', 'mm/s', 1e-3], force: ['friction force', 'mN', 1e-3] };
const find = (id) => document.getElementById(id);
const sound = { context: null, source: null };

/** Return by how much the sound is faster than the sliding: as chosen, or until the slider can be heard. */
sound.factor = () => {
  const chosen = find('sound-speed').value;
  if (chosen !== 'auto') return Number(chosen);
  return FACTORS.find((factor) => factor * rub.exact().naturalFrequency >= AUDIBLE) ?? FACTORS[FACTORS.length - 1];
};

/** Return samples of the run from where it is on: mean removed, peak as given, and what they stand for. */
sound.samples = (rate) => {
  const factor = sound.factor();
  const { speed } = rub.world;
  const { from, seconds, at } = heard(rub.run, LONGEST * factor, speed);
  const count = Math.max(0, Math.floor((seconds * rate) / factor));
  const values = Float32Array.from({ length: count }, (_, i) => at(from + (i * factor) / rate));
  return { ...levelled(values), begin: speed * from, length: speed * seconds, factor };
};

/** Return the seconds of a run that are heard, up to so many, from a time on, and what is heard at a time. */
function heard({ motion, trace, time, distance, end }, most, speed) {
  const name = find('sound-what').value;
  if (motion) {
    motion.until({ time: time + most, work: HEARD_WORK }); // as much as can be computed at once
    return { from: time, seconds: Math.min(most, motion.time - time), at: (now) => motion.at(name, now) };
  }
  const length = Math.min(most * speed, end);
  const begin = Math.max(0, Math.min(distance, end - length));
  trace.until(Math.ceil((begin + length) / trace.tick));
  const known = (trace.ready - 2) * trace.tick - begin;
  return { from: begin / speed, seconds: Math.min(length, known) / speed, at: (now) => trace.at(name, now * speed) };
}

function levelled(values) {
  const mean = values.reduce((sum, value) => sum + value, 0) / Math.max(1, values.length);
  const peak = values.reduce((most, value) => Math.max(most, Math.abs(value - mean)), 0) || 1;
  return { samples: values.map((value) => (PEAK * (value - mean)) / peak), mean, peak };
}

/** Return in words what is heard. */
function mapping({ begin, length, factor, peak, mean }) {
  const [name, unit, scale] = WHAT[find('sound-what').value];
  const own = rub.exact().naturalFrequency;
  const seconds = length / rub.world.speed;
  const way = rub.run.motion ? 'µm of the drive’s way' : 'µm of sliding';
  return (
    `${name}, ${said(begin, 4)} to ${said(begin + length, 4)} ${way}: ${said(seconds, 3)} s heard in ` +
    `${said(seconds / factor, 3)} s. The slider’s ${said(own)} Hz sound as ${said(own * factor)} Hz. ` +
    `Loudest: ${said(peak * scale, 3)} ${unit} from the mean of ${said(mean * scale, 3)} ${unit}.`
  );
}

/** Stop what sounds. */
sound.stop = () => {
  sound.source?.stop();
  sound.source = null;
  find('sound-play').textContent = '♪ listen';
};

/** Play samples until their end. */
sound.start = (samples) => {
  sound.context ??= new AudioContext();
  const buffer = sound.context.createBuffer(1, samples.length, sound.context.sampleRate);
  buffer.copyToChannel(samples, 0);
  const source = new AudioBufferSourceNode(sound.context, { buffer });
  source.connect(sound.context.destination);
  source.onended = () => sound.source === source && sound.stop();
  source.start();
  sound.source = source;
  find('sound-play').textContent = '■ stop';
};

/** Play, or stop what plays. */
sound.toggle = () => {
  if (sound.source) return sound.stop();
  sound.context ??= new AudioContext();
  const made = sound.samples(sound.context.sampleRate);
  find('sound-mapping').textContent = mapping(made);
  if (!made.samples.length) return undefined;
  sound.start(made.samples);
  return undefined;
};

function named(factor) {
  if (factor === 1) return '1 time: true speed';
  return factor < 1 ? `1/${1 / factor} times` : `${factor} times`;
}

sound.begin = () => {
  find('sound-speed').innerHTML =
    '<option value="auto">until audible</option>' +
    FACTORS.map((factor) => `<option value="${factor}">${named(factor)}</option>`).join('');
  find('sound-play').addEventListener('click', sound.toggle);
  rub.on('settings', () => sound.source && sound.stop());
};

Object.assign(sound, { FACTORS, AUDIBLE, PEAK });
rub.sound = sound;
