/* The settings of the page, what is exact about them, and who wants to know when something happens. */
/** Settings that decide about junctions; the others concern the slider alone. */
const CONTACT = ['meanArea', 'meanCount', 'spread', 'births', 'pulse', 'offset', 'calibration', 'seed', 'sizes'];
const CHOICES = {
  births: ['poisson', 'regular'],
  pulse: ['lens', 'triangle', 'parabola'],
  sizes: ['normal', 'rayleigh'],
  support: ['gap', 'load', 'free'],
  offset: ['none', 'uniform'],
  calibration: ['paper', 'exact', 'matched'],
  coupling: ['one-way', 'two-way'],
};
const LIMITS = {
  meanArea: [1, 10000],
  meanCount: [0.5, 400],
  heights: [0.05, 50],
  spread: [0, 20],
  speed: [1, 1e7],
  strength: [0.1, 1e5],
  mass: [1e-6, 10],
  stiffness: [0.1, 1e7],
  damping: [0, 1e3],
  seed: [0, 2 ** 53 - 1],
};
const listeners = new Map();
let exactNow = null;

/** Call f at each of the events "tick", "select", "reset" or "settings" from now on. */
function on(event, f) {
  listeners.set(event, [...(listeners.get(event) ?? []), f]);
}

/** Call all listeners of an event. */
function emit(event, about) {
  for (const f of listeners.get(event) ?? []) f(about);
}

/** Return why a setting cannot be so, or an empty text. */
function problemWith(key, value) {
  if (CHOICES[key]) return CHOICES[key].includes(value) ? '' : `${key}: ${CHOICES[key].join(' or ')}`;
  if (!LIMITS[key]) return `${key}: no such setting`;
  const [low, high] = LIMITS[key];
  const good = typeof value === 'number' && value >= low && value <= high;
  return good ? '' : `${key}: a number from ${low} to ${high}`;
}

const RISES = 'a slider that rises needs parabolas, Rayleigh’s sizes, births at random and a constant speed';
const CENTRED = 'passes off the centre line need the lens, births at random and a constant speed of the drive';

/** Return why a world cannot be, or an empty text. */
function problemOf(world) {
  const isKnown = world.pulse === 'lens' && world.births === 'poisson' && world.coupling === 'one-way';
  if (world.offset === 'uniform' && !isKnown) return CENTRED;
  const rough = { pulse: 'parabola', sizes: 'rayleigh', births: 'poisson', coupling: 'one-way' };
  const isRough = Object.entries(rough).every(([key, value]) => world[key] === value);
  if (world.support !== 'gap' && !isRough) return RISES;
  if (world.pulse === 'lens' || world.calibration !== 'paper') {
    if (!(rub.model.calibratedDiameter(world) > 0)) return 'no mean diameter matches this mean area with this spread';
  }
  if (world.support === 'free' && rub.flight.problemOf(world)) return rub.flight.problemOf(world);
  const { sizes } = rub.model.contact(world);
  const isSpread = world.sizes !== 'rayleigh' && world.spread > 2 * sizes.mean;
  if (isSpread) return 'this spread is more than twice the mean diameter';
  return '';
}

/**
 * Change settings and make a new run of them; return false, and emit "refused", where they cannot be. With
 * {restart: false} the run goes on from the distance where it was.
 */
function set(values, { restart = true } = {}) {
  const wanted = { ...rub.world, ...values };
  const wrong = Object.entries(values).map(([key, value]) => problemWith(key, value));
  const problem = wrong.find((each) => each) ?? problemOf(wanted);
  if (problem) {
    emit('refused', problem);
    return false;
  }
  const rows = CONTACT.some((key) => rub.world[key] !== wanted[key]);
  if (rows) rub.replaying = false;
  Object.assign(rub.world, wanted);
  exactNow = null;
  rub.run.renew({ keep: !restart && !rows });
  emit('settings', values);
  return true;
}

/** Return to the settings that the page was made with. */
function reset() {
  Object.assign(rub.world, rub.given);
  exactNow = null;
  rub.replaying = Boolean(rub.lesson.record);
  rub.run.renew({ keep: false });
  emit('settings', rub.given);
}

/** Return what is exact about the settings; see theory.js. */
function exact() {
  return (exactNow ??= rub.theory.exact(rub.world));
}

/** Begin with what the page was made with: {world, title, distance, record, ...}. */
function begin(lesson) {
  rub.lesson = lesson;
  const usual = { coupling: 'one-way', offset: 'none', sizes: 'normal', support: 'gap', heights: rub.load.SCALE };
  rub.given = Object.freeze({ ...usual, ...lesson.world });
  rub.world = { ...rub.given };
  rub.replaying = Boolean(lesson.record);
  exactNow = null;
}

Object.assign(rub, { on, emit, set, reset, exact, begin });
