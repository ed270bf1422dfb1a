'use strict';
/* The second half of a lesson that goes further: a prediction of its own, a switch, what is seen, law and checks. */
(() => {
  const rub = globalThis.rub;
  const { lessons } = rub;
  const { state, words, page, STEPS } = lessons;
  const { make, grid, part, radio, checkForm, comparison } = page;
  const NOT_YET = 'Opens when you have said what you see above.';
  const UNSAID = 'Opens when you have said what you expect.';
  const UNRUN = 'Opens when the slider has pushed back.';
  const SWITCH = { 'one-way': 'The drive’s speed is constant', 'two-way': 'The slider pushes back' };

  /** Return the sections of a lesson's second half; none where it has no such half. */
  lessons.further = (lesson, index) => {
    const { further } = lesson;
    if (!further) return [];
    const { further: known } = state.lessons[index];
    if (!lessons.revealed(state.lessons[index])) return [part('further', further.title, NOT_YET)];
    const said = known.step >= STEPS.predicted ? '' : UNSAID;
    const run = known.step >= STEPS.run ? '' : UNRUN;
    const question = make('p', { class: 'lesson-question', html: further.question });
    return [
      part('further', further.title, '', question, predict(further, known)),
      part('further-experiment', 'The switch', said, ...(said ? [] : experiment(further, known))),
      part('further-law', 'What happens', run, make('p', { html: comparison(further, known) }), law()),
      part('further-check', 'Check this too', run, ...further.checks.map(checkForm)),
    ];
  };

  function predict(further, known) {
    const done = known.step > STEPS.asked;
    const options = further.prediction.options.map((each) =>
      radio('further-prediction', each, each.text, each.id === known.said, done),
    );
    const form = make('form', { id: 'further-predict', novalidate: true });
    form.append(make('fieldset', {}, make('legend', { text: 'What do you think it does?' }), ...options));
    if (!done) {
      const skip = { type: 'button', 'data-further': 'skip', class: 'quiet', text: 'Skip (teacher)' };
      const buttons = [make('button', { type: 'submit', text: 'Predict' }), make('button', skip)];
      form.append(make('div', { class: 'lesson-buttons' }, ...buttons));
    }
    const noted = done ? `${known.said === 'skipped' ? 'Skipped.' : 'Noted.'} The switch is open.` : '';
    form.append(make('p', { class: 'lesson-verdict', role: 'status', text: noted }));
    return form;
  }

  function experiment({ experiment: { text, label, watch, table } }, { step }) {
    const choices = Object.entries(SWITCH).map(([id, name]) =>
      radio('coupling', { id }, name, rub.world.coupling === id, false),
    );
    const ahead = { type: 'button', class: 'quiet', 'data-act': 'ahead', text: 'Slide 200 lives ahead' };
    const run = make('button', { type: 'button', 'data-further': 'run', text: `▶ ${label}` });
    return [
      make('p', { html: text }),
      make('fieldset', { id: 'further-switch' }, make('legend', { text: 'Coupling' }), ...choices),
      make('div', { class: 'lesson-buttons' }, run, step >= STEPS.run && make('button', ahead)),
      make('p', { text: 'What to watch:' }),
      make('ul', {}, ...watch.map((html) => make('li', { html }))),
      step >= STEPS.run && seenTable(table),
    ].filter(Boolean);
  }

  function seenTable(table) {
    const head = ['quantity', 'seen so far', 'at constant speed, exactly'];
    const rows = table.map((row, i) => {
      const unit = row.unit ? `, ${words.unitName(row.unit)}` : '';
      const name = make('th', { scope: 'row', html: row.label + unit });
      return make('tr', {}, name, make('td', { 'data-further-seen': i }), make('td', { 'data-further-exact': i }));
    });
    return make('div', { class: 'lesson-scroll' }, grid(head, rows));
  }

  function law() {
    const text = make('div', { id: 'further-law-text' });
    return make('details', { id: 'further-why' }, make('summary', { text: 'Show why' }), text);
  }

  /** Write what depends on the settings and on how far the run is. */
  lessons.tellFurther = (root, { experiment: { table } }, seen, exact) => {
    const chosen = root.querySelector(`#coupling-${rub.world.coupling}`);
    if (chosen) chosen.checked = true;
    const write = (name, value) => {
      const cell = root.querySelector(name);
      if (cell) cell.textContent = value;
    };
    table.forEach((row, i) => {
      write(`[data-further-seen="${i}"]`, seen ? words.say(row.seen(seen, exact, rub.world)) : '–');
      write(`[data-further-exact="${i}"]`, words.say(row.exact(exact, rub.world)));
    });
  };

  /** What its buttons do; each returns what is wrong, if anything is. */
  lessons.takeFurther = {
    predict: (further, known, root) => {
      const chosen = root.querySelector('input[name="further-prediction"]:checked');
      if (!chosen) return 'Choose first.';
      Object.assign(known, { said: chosen.value, step: STEPS.predicted });
      return '';
    },
    skip: (further, known) => {
      Object.assign(known, { said: 'skipped', step: STEPS.predicted });
    },
    run: ({ experiment: { set, show, pace } }, known) => {
      rub.set(set, { restart: true });
      rub.show(show);
      rub.transport.pace(rub.exact().lifeMean * pace);
      rub.run.play();
      known.step = STEPS.run;
    },
  };
})();
