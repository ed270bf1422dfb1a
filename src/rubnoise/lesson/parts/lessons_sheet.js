'use strict';
/* Printed, the page is a worksheet: questions with boxes to tick and blanks to fill, and no answer. */
(() => {
  const rub = globalThis.rub;
  const { lessons } = rub;
  const { list, words } = lessons;
  const { make } = lessons.page;

  const blank = (label) => make('p', { class: 'sheet-blank', text: label });
  const boxes = (options, textOf) =>
    make('ul', { class: 'sheet-boxes' }, ...options.map((each) => make('li', { html: textOf(each) })));

  /** Return the whole worksheet: a part to fill in while the lessons are played, and one for afterwards. */
  lessons.sheet = () =>
    make(
      'section',
      { id: 'sheet', 'aria-label': 'Worksheet' },
      make('h1', { text: rub.lesson.title }),
      make('p', { class: 'sheet-name', text: 'Name' }),
      ...list.map(before),
      make('h1', { class: 'sheet-after', text: 'Afterwards' }),
      ...list.map(after),
    );

  const titleOf = (lesson, index) => make('h2', { text: `${index + 1}. ${lesson.title}` });

  /** Return question, prediction and table of a lesson, to fill in while it is played. */
  function before(lesson, index) {
    const { prediction, further } = lesson;
    const parts = [titleOf(lesson, index), make('p', { html: lesson.question })];
    parts.push(boxes(prediction.options, (each) => each.text));
    if (prediction.stake) parts.push(blank('Chips on it (1 to 10)'));
    parts.push(blank('Because'), table(lesson.experiment), blank('What I saw'), blank('The law'));
    if (further) {
      parts.push(make('p', { html: further.question }));
      parts.push(boxes(further.prediction.options, (each) => each.text));
    }
    return make('section', { class: 'sheet-lesson' }, ...parts);
  }

  /** Return the table of an experiment, with an empty cell for each of its runs and for the law. */
  function table({ runs, table: rows, reading }) {
    const cell = (tag, text) => make(tag, tag === 'th' ? { scope: 'col', text } : {});
    const columns = [...runs.map((run) => run.label), ...(reading ? [] : ['the law'])];
    const head = ['quantity', ...columns].map((text) => cell('th', text));
    const body = rows.map((row) => {
      const unit = row.unit ? `, ${words.unitName(row.unit)}` : '';
      const name = make('th', { scope: 'row', html: row.label + unit });
      return make('tr', {}, name, ...columns.map(() => cell('td')));
    });
    return make('table', {}, make('thead', {}, make('tr', {}, ...head)), make('tbody', {}, ...body));
  }

  /** Return the questions of a lesson about what was seen, for the settings of its first run. */
  function after(lesson, index) {
    const world = { ...rub.world, ...lesson.experiment.runs[0].set };
    const exact = rub.theory.exact(world);
    const questions = lesson.checks.flatMap((check) => [
      make('p', { html: check.prompt(exact, world) }),
      check.options ? boxes(check.options, (each) => each.text(exact, world)) : blank('Answer'),
    ]);
    return make('section', { class: 'sheet-lesson' }, titleOf(lesson, index), ...questions);
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
})();
