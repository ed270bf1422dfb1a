'use strict';
/* The lessons: their list, how far each has been taken, and how the page's address keeps that. */
(() => {
  const rub = (globalThis.rub ??= {});

  /** How far a lesson has been taken. */
  const STEPS = { asked: 0, predicted: 1, run: 2, passed: 3 };
  const UNIT_NAMES = { um: 'µm', 'um^2': 'µm²', Hz: 'Hz', s: 's', 'mm/s': 'mm/s', '': '' };

  const DUST = 1e-12; // what rounding leaves where a law says nothing

  /** Return a number as it is said: four digits, no more. */
  function say(value) {
    if (!Number.isFinite(value)) return '–';
    const short = Math.abs(value) < DUST ? 0 : Number(value.toPrecision(4));
    const size = Math.abs(short);
    return (size !== 0 && (size < 1e-3 || size >= 1e6) ? short.toExponential() : String(short)).replace('-', '−');
  }

  const unitName = (unit) => UNIT_NAMES[unit ?? ''];
  const withUnit = (value, unit) => (unit ? `${say(value)} ${unitName(unit)}` : say(value));
  /** Return a reading as it is said: three digits. */
  const say3 = (value) => say(Number(value.toPrecision(3)));
  const words = {
    say,
    say3,
    unitName,
    withUnit,
    um: (value) => withUnit(value, 'um'),
    um2: (value) => withUnit(value, 'um^2'),
    share: (value) => `${say(100 * value)} %`,
  };

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
    const further = { step: STEPS.asked, said: '' };
    const runs = { running: -1, pressed: [], watched: {}, kept: {}, read: {} };
    return { step: STEPS.asked, said: '', stake: 0, look: '', ...runs, right: {}, further };
  }

  /** Return whether the lesson may say what is right: the student has said what is seen, or the teacher has skipped. */
  function revealed({ step, said, look }) {
    return step === STEPS.passed || (step >= STEPS.run && (said === 'skipped' || look !== ''));
  }

  /** Return the option of a prediction that was chosen, or undefined where none was or the teacher skipped it. */
  const chosen = ({ prediction }, { said }) => prediction.options.find((option) => option.id === said);

  /**
   * Return progress as text: for each lesson its step, its prediction as a letter (z: skipped) and its stake; then, of
   * a lesson that goes further, that prediction as a capital letter, and r where its experiment has been run; then,
   * after a hyphen, what was seen.
   */
  function written() {
    return state.lessons
      .map((each, i) => `${stepOf(each, list[i])}${furtherOf(each, list[i])}${lookOf(each, list[i])}`)
      .join('.');
  }

  function lookOf({ look }, lesson) {
    return look ? `-${letterOf(lesson, { said: look })}` : '';
  }

  const stepOf = (known, lesson) => `${known.step}${letterOf(lesson, known)}${known.stake || ''}`;

  function furtherOf({ further: known }, { further }) {
    if (!further) return '';
    return `${letterOf(further, known).toUpperCase()}${known.step >= STEPS.run ? 'r' : ''}`;
  }

  function letterOf({ prediction }, { said }) {
    if (said === 'skipped') return 'z';
    const place = prediction.options.findIndex((option) => option.id === said);
    return place < 0 ? '' : String.fromCharCode(97 + place);
  }

  /** Return the prediction that a letter stands for. */
  function saidBy({ prediction }, letter) {
    return letter === 'z' ? 'skipped' : (prediction.options[letter ? letter.charCodeAt(0) - 97 : -1]?.id ?? '');
  }

  /** Take progress from text; what does not fit is left as it was. */
  function take(text) {
    text
      .split('.')
      .slice(0, list.length)
      .forEach((part, i) => {
        const found = /^([0-3])([a-z]?)(\d{0,2})([A-Z]?)(r?)(?:-([a-y]))?$/.exec(part);
        if (!found) return;
        const [, step, letter, stake, capital, ran, seen] = found;
        const said = saidBy(list[i], letter);
        /* A second half that was begun came after the first had said what is right. */
        const look = said ? saidBy(list[i], seen ?? (capital && letter)) : '';
        const known = { step: said ? Number(step) : 0, said, look, stake: Math.min(10, Number(stake)) };
        state.lessons[i] = { ...fresh(), ...known };
        if (list[i].further) takeFurther(state.lessons[i].further, saidBy(list[i].further, capital.toLowerCase()), ran);
      });
  }

  function takeFurther(known, said, ran) {
    Object.assign(known, { said, step: said ? (ran ? STEPS.run : STEPS.predicted) : STEPS.asked });
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
    return rub.given.coupling === 'two-way' ? list.findIndex((lesson) => lesson.further) : 0;
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

  rub.lessons = {
    STEPS,
    contact,
    swing,
    list,
    state,
    words,
    add,
    fresh,
    revealed,
    beside,
    chosen,
    written,
    recall,
    remember,
    misfit,
  };
})();
