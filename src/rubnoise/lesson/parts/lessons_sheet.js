/* Printed, the page is a worksheet of the open lesson: boxes to tick and blanks to fill, and no answer. */
const { lessons } = rub;
const { list, state, words, given } = lessons;
const { make } = rub;

const blank = (label) => make('p', { class: 'sheet-blank', text: label });
const boxes = (options, textOf) =>
  make('ul', { class: 'sheet-boxes' }, ...options.map((each) => make('li', { html: textOf(each) })));

/** Return the worksheet: a part to fill in while the open lesson is played, and one for afterwards. */
lessons.sheet = () =>
  make(
    'section',
    { id: 'sheet', 'aria-label': 'Worksheet' },
    make('h1', { text: `${state.open + 1}. ${list[state.open].title}` }),
    make('p', { class: 'sheet-name', text: 'Name' }),
    before(list[state.open]),
    make('h1', { class: 'sheet-after', text: 'Afterwards' }),
    ...after(list[state.open]),
  );

/** Return question, prediction and table of a lesson, to fill in while it is played. */
function before(lesson) {
  const { prediction } = lesson;
  const parts = [make('p', { html: lesson.question })];
  parts.push(boxes(prediction.options, (each) => each.text));
  if (prediction.stake) parts.push(blank('Chips on it (1 to 10)'));
  parts.push(blank('Because'), table(lesson.experiment), blank('What I saw'), blank('The law'));
  return make('section', { class: 'sheet-lesson' }, ...parts);
}

/** Return the table of an experiment, with an empty cell for each of its runs and for the law. */
function table({ runs, table: rows, reading }) {
  const columns = [...runs.map((run) => run.label), ...(reading ? [] : ['the law'])];
  const body = rows.map((row) => {
    const unit = row.unit ? `, ${words.unitName(row.unit)}` : '';
    const name = make('th', { scope: 'row', html: row.label + unit });
    return make('tr', {}, name, ...columns.map(() => make('td')));
  });
  return lessons.page.grid(['quantity', ...columns], body, {});
}

/** Return the questions of a lesson about what was seen, for the settings of its first run. */
function after(lesson) {
  const world = { ...rub.world, ...lesson.experiment.runs[0].set };
  const exact = rub.theory.exact(world);
  return lesson.checks.flatMap((check) => [
    make('p', { html: given(check.prompt, exact, world) }),
    check.options ? boxes(check.options, ([text]) => given(text, exact, world)) : blank('Answer'),
  ]);
}

/* Made when a print begins, so that the page holds it no longer than that. */
function printing(isPrinting) {
  document.getElementById('sheet')?.remove();
  if (isPrinting) document.body.append(lessons.sheet());
}

rub.on('ready', () => {
  const print = matchMedia('print');
  print.addEventListener('change', () => printing(print.matches));
  addEventListener('beforeprint', () => printing(true));
  addEventListener('afterprint', () => printing(false));
  document.getElementById('print').addEventListener('click', () => window.print());
});
