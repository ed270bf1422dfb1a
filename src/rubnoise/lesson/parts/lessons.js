/* The lessons: their list, how far each has been taken, and how the page's address keeps that. */
/** How far a lesson has been taken. */
const STEPS = { asked: 0, predicted: 1, run: 2, passed: 3 };
const UNIT_NAMES = { um: 'µm', 'um^2': 'µm²', Hz: 'Hz', s: 's', 'mm/s': 'mm/s', '': '' };

const { said: say } = rub.plot;
const unitName = (unit) => UNIT_NAMES[unit ?? ''];
const withUnit = (value, unit) => (unit ? `${say(value)} ${unitName(unit)}` : say(value));
/** Return a reading as it is said: three digits. */
const say3 = (value) => say(value, 3);
const um = (value) => withUnit(value, 'um');
const um2 = (value) => withUnit(value, 'um^2');
const share = (value) => `${say(100 * value)} %`;
const words = { say, say3, unitName, withUnit, um, um2, share };

/**
 * Return settings of a contact for an experiment: 200 um^2 in 20 equal junctions but for what is given. The diameter
 * is matched, so that the exact mean area is the one that is asked for.
 */
const contact = (values) => ({
  meanArea: 200,
  meanCount: 20,
  spread: 0,
  births: 'poisson',
  pulse: 'lens',
  offset: 'none',
  calibration: 'matched',
  coupling: 'one-way',
  sizes: 'normal',
  support: 'gap',
  heights: rub.load.SCALE,
  ...values,
});

/* The slider of the paper's Fig. 5, in um/s, MPa, kg, N/m and N s/m, and its contact with it. */
const SLIDER = { speed: 1000, strength: 250, mass: 0.005, stiffness: 300, damping: 0.05 };
const fig5 = { ...contact({ spread: 0.2, calibration: 'paper' }), ...SLIDER };

/** Return std/mean times sqrt(N) of equal lenses born at random: sqrt(2 c_2)/c_1. */
function swing() {
  const [first, second] = rub.model.pulses.lens.lifeIntegrals;
  return Math.sqrt(2 * second) / first;
}

const list = [];
const state = { open: 0, lessons: [] };

/** Add a lesson to the end of the list. */
function add(lesson) {
  list.push(lesson);
  state.lessons.push(fresh());
}

/** Return what is known of a lesson that has not begun: no prediction, no stake, no check answered. */
function fresh() {
  const runs = { running: -1, pressed: [], watched: {}, kept: {}, lives: {}, read: {} };
  return { step: STEPS.asked, said: '', stake: 0, look: '', ...runs, right: {} };
}

/** Return whether the lesson may say what is right: the student has said what is seen, or the teacher has skipped. */
function revealed({ step, said, look }) {
  return step === STEPS.passed || (step >= STEPS.run && (said === 'skipped' || look !== ''));
}

/** Return the option of a prediction that was chosen, or undefined where none was or the teacher skipped it. */
const chosen = ({ prediction }, { said }) => prediction.options.find((option) => option.id === said);

/** Return progress as text: for each lesson its step, its prediction, its stake, and what was seen. */
const written = () => state.lessons.map(({ step, said, stake, look }) => [step, said, stake, look].join('_')).join('.');

/** Take progress from text; what does not fit is left as it was. */
function take(text) {
  const parts = text.split('.').slice(0, list.length);
  parts.forEach((part, i) => {
    const [step, said, stake, look] = part.split('_');
    const known = ['', 'skipped', ...list[i].prediction.options.map((option) => option.id)];
    if (![step, stake].every((each) => /^\d{1,2}$/.test(each))) return;
    if (![said, look].every((each) => known.includes(each))) return;
    const taken = said ? { step: Math.min(STEPS.passed, step), said, look } : {};
    state.lessons[i] = { ...fresh(), ...taken, stake: Math.min(10, stake) };
  });
}

/** Read the open lesson and the progress from the page's address; return whether it names a lesson. */
function recall() {
  const open = list.findIndex((lesson) => lesson.id === rub.fragment('lesson'));
  state.open = open >= 0 ? open : first();
  take(rub.fragment('progress') ?? '');
  return open >= 0;
}

/* A scenario whose slider pushes back is about the lesson that has this. */
function first() {
  return rub.given.coupling === 'two-way' ? list.findIndex((lesson) => lesson.id === 'back') : 0;
}

/** Write the open lesson and the progress to the page's address, beside the settings. No storage is used. */
function remember() {
  rub.fragment('lesson', list[state.open].id);
  rub.fragment('progress', written());
}

/** Return the runs of a lesson, which stand beside each other, with what was pressed and what is running. */
const beside = ({ experiment: { runs } }, { pressed, running }) =>
  runs.map((run, i) => ({ ...run, pressed: pressed.includes(i), running: i === running }));

/** Return why the question does not fit the settings any more, or nothing. */
function misfit(lesson, world) {
  const needs = lesson.experiment.reading ? {} : { offset: 'none', ...lesson.needs };
  const turned = Object.entries(needs).find(([key, value]) => world[key] !== value);
  return turned
    ? `The controls have been changed since (${NAMES[turned[0]]}). Press a button of the experiment to set them back.`
    : '';
}

const NAMES = { births: 'births', pulse: 'life', offset: 'passes', spread: 'spread', meanCount: 'mean count' };

/** Return a text of a lesson, or a number, that may depend on what is exact and on the settings. */
const given = (value, exact, world) => (typeof value === 'function' ? value(exact, world) : value);

rub.lessons = { STEPS, SLIDER, fig5, list, state, words };
Object.assign(rub.lessons, { contact, swing, add, fresh, revealed, beside, chosen, written, recall, remember, misfit, given });
