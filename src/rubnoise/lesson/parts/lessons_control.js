/* What happens in the lessons: predicting, running, checking, going on; and what is said about it. */
const { lessons } = rub;
const { list, state, words, page, STEPS } = lessons;
const REFRESH = 500; // ms between two updates of the table: numbers that flicker cannot be read
const phone = matchMedia('(max-width: 55rem)'); // there the pictures lie over the lesson
let root = null;
let refreshed = 0;

const current = () => state.lessons[state.open];
const find = (selector) => root.querySelector(selector);

/** Show the open lesson anew and give the focus to an element of it, if one is named. */
function show(focus) {
  draw();
  lessons.remember();
  if (focus) find(focus)?.focus();
}

function draw() {
  root.replaceChildren(rub.make('h2', { id: 'lessons-title', text: 'Lessons' }), page.contents(), page.article());
  rub.born.begin(find('#born'));
  unveil();
  rub.knobs.fold(list[state.open].controls);
  announce();
}

/** Show the numbers that give no answer away: measured ones after the prediction, exact ones at the end. */
function unveil() {
  const known = current();
  rub.readout.open(lessons.revealed(known) ? 'all' : known.step > STEPS.asked ? 'seen' : 'none');
  if (list[state.open].experiment.reading) lessons.reading.unveil(known);
}

/** Write what depends on the settings: law, prompts, options, what has been seen. */
function announce() {
  const lesson = list[state.open];
  const exact = rub.exact();
  const told = (value) => lessons.given(value, exact, rub.world);
  fill('#lesson-law-text', () => told(lesson.law));
  for (const check of lesson.checks) {
    ask(check, told(check.prompt));
    check.options?.forEach(([text], i) => fill(`label[for="check-${check.id}-${i}"]`, () => told(text)));
  }
  tellSeen(exact);
  rub.drag.write(root);
}

/** Write what a check asks; an answer to other numbers is no answer any more. */
function ask(check, text) {
  const element = find(`[data-prompt="${check.id}"]`);
  if (!element || element.dataset.text === text) return;
  const form = element.closest('form');
  delete form.dataset.verdict;
  form.querySelector('.lesson-verdict').textContent = '';
  element.dataset.text = text;
  element.innerHTML = text;
}

/** Set the content of an element that may be locked away. */
function fill(selector, html) {
  const element = find(selector);
  if (element) element.innerHTML = html();
}

/** Keep what the run shows, and write all that was kept; a control that was turned gets a column of its own. */
function tellSeen(exact = rub.exact()) {
  const lesson = list[state.open];
  if (lesson.experiment.reading) return;
  if (current().step >= STEPS.run) lessons.kept.keep(lesson, current(), lessons.seen(exact), exact);
  const shown = find('.lesson-table');
  if (shown && Number(shown.dataset.columns) !== lessons.kept.columns(lesson, current()).length)
    shown.replaceWith(lessons.kept.table(lesson, current()));
  lessons.kept.write(root, lesson, current());
}

/** Open a lesson. */
function open(index) {
  state.open = index;
  rub.readout.shown = false;
  showPicture();
  show('#lesson-title');
  find('.lesson').scrollIntoView({ block: 'nearest' });
}

/** Show the pictures that the open lesson begins with; none before its prediction: they give answers away. */
function showPicture() {
  const { runs, reading } = list[state.open].experiment;
  const { pressed, step } = current();
  place();
  if (reading) lessons.reading.open(list[state.open], current(), pressed[0] ?? 0);
  rub.show(step > STEPS.asked ? runs[pressed[0] ?? 0].show : '');
}

/** Put the contacts of the open lesson beside each other, if it has two. */
function place() {
  const lesson = list[state.open];
  const { runs, reading } = lesson.experiment;
  rub.beside.show(runs.length > 1 && !reading ? lessons.beside(lesson, current()) : []);
}

function predict() {
  const chosen = find('input[name="prediction"]:checked');
  if (!chosen) return fill('#lesson-predict .lesson-verdict', () => 'Choose first.');
  const stake = find('#lesson-stake');
  if (stake && !(Number.isInteger(stake.valueAsNumber) && stake.checkValidity())) {
    return fill('#lesson-predict .lesson-verdict', () => 'A bet has from 1 to 10 chips.');
  }
  Object.assign(current(), { said: chosen.value, stake: stake ? stake.valueAsNumber : 0, step: STEPS.predicted });
  show('[data-run]');
}

function skip() {
  Object.assign(current(), { said: 'skipped', step: STEPS.predicted });
  show('[data-run]');
}

function restart() {
  state.lessons[state.open] = lessons.fresh();
  show('#lesson-title');
}

/** Set the knobs as an experiment wants them and let it run. */
function run(index) {
  const lesson = list[state.open];
  const chosen = lesson.experiment.runs[index];
  current().running = index;
  rub.set(chosen.set, { restart: true });
  rub.transport.pace(rub.exact().lifeMean * lesson.experiment.pace);
  rub.run.play();
  current().pressed = [index, ...current().pressed.filter((other) => other !== index)];
  place();
  if (chosen.trace) lessons.reading.open(lesson, current(), index);
  if (current().step < STEPS.run || chosen.trace) {
    current().step = Math.max(current().step, STEPS.run);
    show(`[data-run="${index}"]`);
  }
  rub.show(chosen.show);
  if (phone.matches) find('.lesson-experiment').scrollIntoView();
  find('#reading-form')?.scrollIntoView({ block: 'nearest' });
  if (!chosen.trace) fill('#lesson-running', () => `${chosen.label}: running.`);
}

/** Ask what is seen as soon as enough has been, without taking the focus away. */
function watchOn() {
  const lesson = list[state.open];
  if (lessons.watch(lesson, current()) && !lessons.revealed(current())) {
    find('.lesson-look')?.replaceWith(page.look(lesson, current()));
  }
}

/** Take what the student sees; then the lesson says what is right. */
function observe() {
  const chosen = find('input[name="observation"]:checked');
  if (!chosen) return fill('#lesson-observe .lesson-verdict', () => 'Choose first.');
  current().look = chosen.value;
  return show('#lesson-why summary');
}

/** Take a reading by eye; then the page shows how others read the trace. */
function note() {
  const problem = lessons.reading.note(list[state.open], current());
  if (problem) fill('#reading-form .lesson-verdict', () => problem);
  else show(lessons.reading.next(list[state.open], current()));
}

/** Lay the cursor over the last ten swings and say what it measures. */
function measure() {
  fill('#lesson-running', () => rub.swings.ten());
}

/** Play the sound of a run; the run on the stage stays as it is. */
function listen(index) {
  const told = lessons.sounds.play(list[state.open].experiment, index);
  if (told) fill('#lesson-running', () => told);
}

/** Slide on at once by many lives, for those who want figures and not the show. */
function ahead() {
  const { run: going } = rub;
  going.goTo(Math.min(going.end, going.distance + lessons.ahead(list[state.open]) * rub.exact().lifeMean));
  refresh();
  const lives = words.say(Math.round(going.distance / rub.exact().lifeMean));
  fill('#lesson-running', () => `Now at ${lives} lives${going.distance < going.end ? '' : ', the end of the run'}.`);
}

function check(form) {
  const lesson = list[state.open];
  const asked = lesson.checks.find((each) => each.id === form.dataset.check);
  const field = form.querySelector('input[type="text"], input:checked');
  const verdict = lessons.judge(lesson, asked, field ? field.value : '');
  const line = form.querySelector('.lesson-verdict');
  line.innerHTML = verdict.message;
  form.dataset.verdict = verdict.right ? 'right' : 'wrong';
  current().right[asked.id] = verdict.right;
  if (lesson.checks.every((each) => current().right[each.id])) pass();
}

/** Mark the lesson as passed, without taking the focus or the answers away. */
function pass() {
  current().step = STEPS.passed;
  unveil();
  lessons.remember();
  find('nav').replaceWith(page.contents());
  find('.lesson-table').replaceWith(page.seenTable(list[state.open], current()));
  tellSeen();
  const last = list.every((_, i) => state.lessons[i].step === STEPS.passed);
  fill('#lesson-end', () => (last ? 'All lessons done.' : 'Lesson done.'));
}

const ACTS = { skip, ahead, measure, restart };
const FORMS = { 'lesson-predict': predict, 'lesson-observe': observe, 'reading-form': note };

function clicked(event) {
  const button = event.target.closest('button');
  if (!button) return;
  const { open: index, run: chosen, act, sound } = button.dataset;
  if (index !== undefined) open(Number(index));
  else if (chosen !== undefined) run(Number(chosen));
  else if (sound !== undefined) listen(Number(sound));
  else ACTS[act]?.();
}

function submitted(event) {
  event.preventDefault();
  const act = FORMS[event.target.id] ?? check;
  act(event.target);
}

function ticked() {
  const now = performance.now();
  if (now - refreshed < REFRESH) return;
  refreshed = now;
  refresh();
}

/** Take notice of what the run shows now. */
function refresh() {
  watchOn();
  tellSeen();
}

/** Take up what another address says, such as one that was passed on. */
function follow() {
  const before = `${rub.fragment('lesson')} ${rub.fragment('progress')}`;
  if (before === `${list[state.open].id} ${lessons.written()}`) return;
  if (lessons.recall()) draw();
}

/** Put the lessons into their section of the page. */
function mount() {
  root = document.getElementById('lessons');
  const recalled = lessons.recall();
  root.addEventListener('click', clicked);
  root.addEventListener('submit', submitted);
  rub.on('tick', ticked);
  rub.on('settings', announce);
  addEventListener('hashchange', follow);
  draw();
  showPicture();
  if (recalled) root.scrollIntoView();
}

Object.assign(lessons, { open, refresh });
rub.on('ready', mount);
