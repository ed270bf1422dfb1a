'use strict';
/* The open lesson as elements of the page: question, prediction, experiment, law, checks. */
(() => {
  const { lessons } = globalThis.rub;
  const { list, state, words, STEPS } = lessons;
  const LOCKED = {
    experiment: 'Opens when you have made your prediction.',
    after: 'Opens when you have said what you see.',
  };
  const AHEAD = { type: 'button', class: 'quiet', 'data-act': 'ahead' };

  /** Return a new element with attributes (text: its text, html: its content) and children. */
  function make(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (name === 'text') element.textContent = value;
      else if (name === 'html') element.innerHTML = value;
      else if (value !== false && value !== undefined) element.setAttribute(name, value === true ? '' : value);
    }
    element.append(...children.filter(Boolean));
    return element;
  }

  /** Return a table of a header's texts and rows of elements. */
  function grid(head, rows, attributes = { class: 'lesson-table' }) {
    const names = head.map((html) => make('th', { scope: 'col', html }));
    return make('table', attributes, make('thead', {}, make('tr', {}, ...names)), make('tbody', {}, ...rows));
  }

  /** Return a part with its heading; while locked its body is away and a note says when it opens. */
  function part(name, title, locked, ...body) {
    const id = `lesson-${name}`;
    const content = locked ? [make('p', { class: 'lesson-locked', text: locked })] : body;
    return make(
      'section',
      { class: `lesson-part ${id}`, 'aria-labelledby': id },
      make('h4', { id, text: title }),
      ...content,
    );
  }

  function radio(group, option, html, checked, disabled) {
    const id = `${group}-${option.id}`;
    const input = make('input', { type: 'radio', name: group, value: option.id, id, checked, disabled });
    return make('div', { class: 'lesson-option' }, input, make('label', { for: id, html }));
  }

  function prediction(lesson, index) {
    const { said, stake, step } = state.lessons[index];
    const done = step > STEPS.asked;
    const options = lesson.prediction.options.map((each) =>
      radio('prediction', each, each.text, each.id === said, done),
    );
    const form = make('form', { id: 'lesson-predict', novalidate: true });
    form.append(make('fieldset', {}, make('legend', { text: 'What do you expect?' }), ...options));
    if (lesson.prediction.stake) form.append(stakeField(stake, done));
    if (!done) form.append(make('div', { class: 'lesson-buttons' }, ...predictionButtons(lesson)));
    form.append(make('p', { class: 'lesson-verdict', role: 'status', html: done ? noted(index) : '' }));
    return part('prediction', lesson.prediction.stake ? 'Your bet' : 'Your prediction', '', form);
  }

  function predictionButtons(lesson) {
    const name = lesson.prediction.stake ? 'Place the bet' : 'Predict';
    return [
      make('button', { type: 'submit', text: name }),
      make('button', { type: 'button', 'data-act': 'skip', class: 'quiet', text: 'Skip (teacher)' }),
    ];
  }

  function stakeField(stake, disabled) {
    const input = make('input', {
      type: 'number',
      id: 'lesson-stake',
      min: 1,
      max: 10,
      step: 1,
      value: stake || 5,
      disabled,
    });
    return make(
      'p',
      { class: 'lesson-field' },
      make('label', { for: 'lesson-stake', text: 'Chips on it (1 to 10)' }),
      input,
    );
  }

  function noted(index) {
    const { said, stake } = state.lessons[index];
    if (said === 'skipped') return 'Skipped. The experiment is open.';
    return stake ? `Your bet of ${stake} chips stands. The experiment is open.` : 'Noted. The experiment is open.';
  }

  function experiment(lesson, index) {
    const { step } = state.lessons[index];
    const locked = step < STEPS.predicted ? LOCKED.experiment : '';
    const { text, runs, watch, reading, measure } = lesson.experiment;
    const begun = step >= STEPS.run;
    const buttons = runs.flatMap((run, i) => [
      make('button', { type: 'button', 'data-run': i, text: `▶ ${run.label}` }),
      begun && lesson.experiment.sound && soundButton(run, i),
    ]);
    return part(
      'experiment',
      'Experiment',
      locked,
      make('p', { html: text }),
      make(
        'div',
        { class: 'lesson-buttons' },
        ...buttons,
        begun && measure && make('button', { ...AHEAD, 'data-act': 'measure', text: 'measure ten swings' }),
        begun && !reading && make('button', { ...AHEAD, text: `Slide ${lessons.ahead(lesson)} lives ahead` }),
      ),
      make('p', { class: 'lesson-verdict', id: 'lesson-running', role: 'status' }),
      begun && reading && lessons.reading.form(lesson, state.lessons[index]),
      make('p', { text: 'What to watch:' }),
      make('ul', {}, ...watch.map((html) => make('li', { html }))),
      begun && seenTable(lesson, index),
    );
  }

  /** Return the button that plays a run as sound, on one scale with the others. */
  function soundButton({ label }, i) {
    const text = `♪ ${lessons.sounds.LETTERS[i]}`;
    return make('button', { type: 'button', class: 'quiet', 'data-sound': i, text, 'aria-label': `${text}: ${label}` });
  }

  /** Return the table of what the runs have shown. */
  function seenTable(lesson, index) {
    const known = state.lessons[index];
    const table = lesson.experiment.reading ? lessons.reading.table(lesson, known) : lessons.kept.table(lesson, known);
    return make('div', { class: 'lesson-scroll' }, table);
  }

  function law(lesson, index) {
    const known = state.lessons[index];
    const locked = lessons.revealed(known) ? '' : LOCKED.after;
    const details = make(
      'details',
      { id: 'lesson-why' },
      make('summary', { text: 'Show the law' }),
      make('div', { id: 'lesson-law-text' }),
    );
    const settled = lesson.settle && !locked ? `${lesson.settle(known, globalThis.rub.world)} ` : '';
    const said = settled + comparison(lesson, known);
    return part('law', 'The law', locked, make('p', { id: 'lesson-said', html: said }), details);
  }

  /** Return the prediction beside what is right. */
  function comparison(lesson, known) {
    const option = lessons.chosen(lesson, known);
    const truth = lesson.prediction.options.find((each) => each.right);
    if (!option) return `What is right: <em>${truth.text}</em>.`;
    if (option.right) return `You expected: <em>${option.text}</em>. So it is.`;
    return `You expected: <em>${option.text}</em>. What is right: <em>${truth.text}</em>.`;
  }

  function checks(lesson, index) {
    const locked = lessons.revealed(state.lessons[index]) ? '' : LOCKED.after;
    return part('check', 'Check', locked, ...lesson.checks.map((check) => checkForm(check)));
  }

  function checkForm(check) {
    const id = `check-${check.id}`;
    const body = check.options ? choices(check, id) : check.met ? [prompt(check)] : number(check, id);
    return make(
      'form',
      { class: 'lesson-check', 'data-check': check.id, novalidate: true },
      ...body,
      make('button', { type: 'submit', text: 'Check' }),
      make('p', { class: 'lesson-verdict', role: 'status', id: `${id}-verdict` }),
    );
  }

  const prompt = (check, tag = 'p', attributes = {}) => make(tag, { 'data-prompt': check.id, ...attributes });

  function choices(check, id) {
    const options = check.options.map((each) => radio(id, each, '', false, false));
    return [make('fieldset', {}, prompt(check, 'legend'), ...options)];
  }

  function number(check, id) {
    const name = words.unitName(check.unit);
    const input = make('input', {
      type: 'text',
      id,
      inputmode: 'text',
      autocomplete: 'off',
      maxlength: 40,
      size: 12,
      'aria-describedby': `${id}-form`,
    });
    const form = `${name ? `in ${name}, ` : ''}within ${words.share(check.tolerance)}`;
    return [
      prompt(check, 'label', { for: id }),
      make(
        'p',
        { class: 'lesson-field' },
        input,
        make('span', { id: `${id}-form`, class: 'lesson-quiet', text: form }),
      ),
    ];
  }

  function footer(index) {
    const next = list[index + 1];
    const previous = list[index - 1];
    return make(
      'nav',
      { class: 'lesson-buttons', 'aria-label': 'Between lessons' },
      previous &&
        make('button', {
          type: 'button',
          class: 'quiet',
          'data-open': index - 1,
          text: `← ${index}. ${previous.title}`,
        }),
      make('button', { type: 'button', class: 'quiet', 'data-act': 'restart', text: 'Start this lesson again' }),
      next && make('button', { type: 'button', 'data-open': index + 1, text: `${index + 2}. ${next.title} →` }),
    );
  }

  /** Return the list of lessons, with a tick beside those that were passed. */
  function contents() {
    const items = list.map((lesson, i) => {
      const passed = state.lessons[i].step === STEPS.passed;
      const isOpen = i === state.open ? 'step' : false;
      const button = make(
        'button',
        { type: 'button', 'data-open': i, 'aria-current': isOpen, title: lesson.title },
        `${i + 1}.`,
        make('span', { class: 'lesson-name', text: ` ${lesson.title}` }),
      );
      if (passed)
        button.append(
          make('span', { class: 'lesson-done', text: ' ✓' }),
          make('span', { class: 'lesson-unseen', text: ' done' }),
        );
      return make('li', {}, button);
    });
    return make('nav', { 'aria-label': 'Lessons' }, make('ol', { class: 'lesson-list' }, ...items));
  }

  /** Return the open lesson as one article. */
  function article() {
    const index = state.open;
    const lesson = list[index];
    return make(
      'article',
      { class: 'lesson', 'data-lesson': lesson.id, 'aria-labelledby': 'lesson-title' },
      make('h3', { id: 'lesson-title', tabindex: -1, text: `${index + 1}. ${lesson.title}` }),
      make('p', { class: 'lesson-question', html: lesson.question }),
      lesson.opening && make('figure', { class: 'lesson-opening', html: lesson.opening }),
      prediction(lesson, index),
      experiment(lesson, index),
      lessons.look(lesson, index) ?? '',
      law(lesson, index),
      checks(lesson, index),
      ...lessons.further(lesson, index),
      make('p', { class: 'lesson-verdict', id: 'lesson-end', role: 'status' }),
      footer(index),
    );
  }

  lessons.page = { make, grid, part, radio, comparison, checkForm, contents, article, seenTable };
})();
