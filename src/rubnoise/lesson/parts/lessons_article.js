/* The open lesson as elements of the page: question, prediction, experiment, what is seen, law, checks. */
const { lessons, make } = rub;
const { list, state, words, STEPS } = lessons;
const LOCKED = {
  experiment: 'Opens when you have made your prediction.',
  after: 'Opens when you have said what you see.',
};

/** Return a table of a header's texts and rows of elements. */
function grid(head, rows, attributes = { class: 'lesson-table' }) {
  const names = head.map((html) => make('th', { scope: 'col', html }));
  return make('table', attributes, make('thead', {}, make('tr', {}, ...names)), make('tbody', {}, ...rows));
}

const button = (text, attributes) => make('button', { type: 'button', text, ...attributes });
const quiet = (text, attributes) => button(text, { class: 'quiet', ...attributes });
const buttons = (...all) => make('div', { class: 'lesson-buttons' }, ...all);
const verdict = (attributes) => make('p', { class: 'lesson-verdict', role: 'status', ...attributes });

/** Return a part with its heading; while locked its body is away and a note says when it opens. */
function part(name, title, locked, ...body) {
  const id = `lesson-${name}`;
  const content = locked ? [make('p', { class: 'lesson-locked', text: locked })] : body;
  const heading = make('h4', { id, text: title });
  return make('section', { class: `lesson-part ${id}`, 'aria-labelledby': id }, heading, ...content);
}

/** Return a group of choices: {id, html} each. */
function choice(group, legend, options, chosen, disabled) {
  const radios = options.map(({ id: value, html }) => {
    const id = `${group}-${value}`;
    const input = make('input', { type: 'radio', name: group, value, id, checked: value === chosen, disabled });
    return make('div', { class: 'lesson-option' }, input, make('label', { for: id, html }));
  });
  return make('fieldset', {}, legend, ...radios);
}

const predictable = ({ prediction }) => prediction.options.map(({ id, text }) => ({ id, html: text }));

function prediction(lesson, known) {
  const isBet = lesson.prediction.stake;
  const done = known.step > STEPS.asked;
  const legend = make('legend', { text: 'What do you expect?' });
  const form = make(
    'form',
    { id: 'lesson-predict', novalidate: true },
    choice('prediction', legend, predictable(lesson), known.said, done),
    isBet && stakeField(known.stake, done),
    !done &&
      buttons(
        make('button', { type: 'submit', text: isBet ? 'Place the bet' : 'Predict' }),
        quiet('Skip (teacher)', { 'data-act': 'skip' }),
      ),
    verdict({ html: done ? noted(known) : '' }),
  );
  return part('prediction', isBet ? 'Your bet' : 'Your prediction', '', form);
}

function stakeField(stake, disabled) {
  const id = 'lesson-stake';
  const input = make('input', { type: 'number', id, min: 1, max: 10, step: 1, value: stake || 5, disabled });
  return make('p', { class: 'lesson-field' }, make('label', { for: id, text: 'Chips on it (1 to 10)' }), input);
}

function noted({ said, stake }) {
  if (said === 'skipped') return 'Skipped. The experiment is open.';
  return stake ? `Your bet of ${stake} chips stands. The experiment is open.` : 'Noted. The experiment is open.';
}

function experiment(lesson, known) {
  const locked = known.step < STEPS.predicted ? LOCKED.experiment : '';
  const { text, runs, watch, reading, measure, sound } = lesson.experiment;
  const begun = known.step >= STEPS.run;
  const starts = runs.flatMap((run, i) => [button(`▶ ${run.label}`, { 'data-run': i }), begun && sound && ear(run, i)]);
  const act = (name, what) => quiet(name, { 'data-act': what });
  return part(
    'experiment',
    'Experiment',
    locked,
    make('p', { html: text }),
    buttons(
      ...starts,
      begun && measure && act('measure ten swings', 'measure'),
      begun && !reading && act(`Slide ${lessons.ahead(lesson)} lives ahead`, 'ahead'),
    ),
    verdict({ id: 'lesson-running' }),
    begun && reading && lessons.reading.form(lesson, known),
    make('p', { text: 'What to watch:' }),
    make('ul', {}, ...watch.map((html) => make('li', { html }))),
    begun && make('div', { class: 'lesson-scroll' }, seenTable(lesson, known)),
  );
}

/** Return the button that plays a run as sound, on one scale with the others. */
function ear({ label }, i) {
  const text = `♪ ${lessons.sounds.LETTERS[i]}`;
  return quiet(text, { 'data-sound': i, 'aria-label': `${text}: ${label}` });
}

/** Return the table of what the runs have shown. */
const seenTable = (lesson, known) =>
  (lesson.experiment.reading ? lessons.reading : lessons.kept).table(lesson, known);

/** Return the question what is seen; none where a teacher has skipped the prediction. */
function look(lesson, known) {
  if (known.said === 'skipped') return null;
  const done = lessons.revealed(known);
  const which = lesson.experiment.runs.length > 1 ? 'each run has' : 'the run has';
  const waiting = lesson.experiment.reading
    ? 'Opens when you have read all three traces.'
    : `Opens when ${which} gone on for ${lessons.lives(lesson)} lives.`;
  const isOpen = done || (known.step >= STEPS.run && lessons.enough(lesson, known));
  return part('look', 'What do you see?', isOpen ? '' : waiting, done ? seen(lesson, known) : observation(lesson));
}

function seen(lesson, known) {
  const option = lessons.chosen(lesson, { said: known.look });
  const answer = option ? lessons.kept.answer(lesson, known, option) : '';
  return make('p', { html: option ? `You saw: <em>${option.text}</em>. ${answer}` : 'Said.' });
}

function observation(lesson) {
  const legend = make('legend', { html: lesson.evidence?.asks ?? 'What would you say now?' });
  return make(
    'form',
    { id: 'lesson-observe', novalidate: true },
    choice('observation', legend, predictable(lesson)),
    make('button', { type: 'submit', text: 'Say so' }),
    verdict(),
  );
}

function law(lesson, known) {
  const locked = lessons.revealed(known) ? '' : LOCKED.after;
  const text = make('div', { id: 'lesson-law-text' });
  const details = make('details', { id: 'lesson-why' }, make('summary', { text: 'Show the law' }), text);
  const settled = lesson.settle && !locked ? `${lesson.settle(known, rub.world)} ` : '';
  const said = make('p', { id: 'lesson-said', html: settled + comparison(lesson, known) });
  return part('law', 'The law', locked, said, details);
}

/** Return the prediction beside what is right. */
function comparison(lesson, known) {
  const option = lessons.chosen(lesson, known);
  const truth = lesson.prediction.options.find((each) => each.right);
  if (!option) return `What is right: <em>${truth.text}</em>.`;
  if (option.right) return `You expected: <em>${option.text}</em>. So it is.`;
  return `You expected: <em>${option.text}</em>. What is right: <em>${truth.text}</em>.`;
}

function checkForm(check) {
  const id = `check-${check.id}`;
  return make(
    'form',
    { class: 'lesson-check', 'data-check': check.id, novalidate: true },
    ...(check.options ? [choices(check, id)] : check.met ? [prompt(check, 'p')] : number(check, id)),
    make('button', { type: 'submit', text: 'Check' }),
    verdict({ id: `${id}-verdict` }),
  );
}

const prompt = (check, tag, attributes = {}) => make(tag, { 'data-prompt': check.id, ...attributes });

const choices = (check, id) =>
  choice(
    id,
    prompt(check, 'legend'),
    check.options.map((_, i) => ({ id: i, html: '' })),
  );

function number(check, id) {
  const name = words.unitName(check.unit);
  const about = `${id}-form`;
  const typed = { type: 'text', inputmode: 'text', autocomplete: 'off', maxlength: 40, size: 12 };
  const text = `${name ? `in ${name}, ` : ''}within ${words.share(check.tolerance)}`;
  const input = make('input', { id, ...typed, 'aria-describedby': about });
  const field = make('p', { class: 'lesson-field' }, input, make('span', { id: about, class: 'lesson-quiet', text }));
  return [prompt(check, 'label', { for: id }), field];
}

function footer(index) {
  const [previous, next] = [list[index - 1], list[index + 1]];
  return make(
    'nav',
    { class: 'lesson-buttons', 'aria-label': 'Between lessons' },
    previous && quiet(`← ${index}. ${previous.title}`, { 'data-open': index - 1 }),
    quiet('Start this lesson again', { 'data-act': 'restart' }),
    next && button(`${index + 2}. ${next.title} →`, { 'data-open': index + 1 }),
  );
}

/** Return the list of lessons, with a tick beside those that were passed. */
function contents() {
  const items = list.map((lesson, i) => {
    const passed = state.lessons[i].step === STEPS.passed;
    const isOpen = i === state.open ? 'step' : false;
    return make(
      'li',
      {},
      make(
        'button',
        { type: 'button', 'data-open': i, 'aria-current': isOpen, title: lesson.title },
        `${i + 1}.`,
        make('span', { class: 'lesson-name', text: ` ${lesson.title}` }),
        passed && make('span', { class: 'lesson-done', text: ' ✓' }),
        passed && make('span', { class: 'lesson-unseen', text: ' done' }),
      ),
    );
  });
  return make('nav', { 'aria-label': 'Lessons' }, make('ol', { class: 'lesson-list' }, ...items));
}

/** Return the open lesson as one article. */
function article() {
  const index = state.open;
  const [lesson, known] = [list[index], state.lessons[index]];
  const checks = lesson.checks.map(checkForm);
  return make(
    'article',
    { class: 'lesson', 'data-lesson': lesson.id, 'aria-labelledby': 'lesson-title' },
    make('h3', { id: 'lesson-title', tabindex: -1, text: `${index + 1}. ${lesson.title}` }),
    make('p', { class: 'lesson-question', html: lesson.question }),
    lesson.opening && make('figure', { class: 'lesson-opening', html: lesson.opening }),
    prediction(lesson, known),
    experiment(lesson, known),
    look(lesson, known),
    law(lesson, known),
    part('check', 'Check', lessons.revealed(known) ? '' : LOCKED.after, ...checks),
    verdict({ id: 'lesson-end' }),
    footer(index),
  );
}

lessons.page = { grid, contents, article, look, seenTable };
