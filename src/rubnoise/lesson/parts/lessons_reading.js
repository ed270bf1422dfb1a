'use strict';
/* The lesson that reads a size off a trace: the form of the bar, and the table of what was read in three ways. */
(() => {
  const rub = globalThis.rub;
  const { lessons, reading } = rub;
  const { words, STEPS } = lessons;
  const { make } = rub;
  const { LEVELS } = reading;
  const STEP = 0.4; // um of both sliders: a tick

  const lawOf = (lesson, index) => lesson.experiment.runs[index].trace;
  const lawsOf = (lesson) => lesson.experiment.runs.map((run) => run.trace);

  /** Return whether all traces have been read by eye. */
  const isDone = (lesson, { read }) => lawsOf(lesson).every((law) => law in read);

  /** Return what may be seen of a trace: its size is read by eye first, and the truth comes last. */
  function levelOf(law, known) {
    if (lessons.revealed(known)) return LEVELS.truth;
    return law in known.read ? LEVELS.readings : LEVELS.trace;
  }

  /** Tell the pictures what they may show. */
  function unveil(known) {
    reading.level = levelOf(reading.current().law, known);
    reading.noted = (law) => known.read[law];
    rub.emit('reading', reading.law);
  }

  /** Open the trace of a run. */
  function open(lesson, known, index) {
    reading.open(lawOf(lesson, index));
    unveil(known);
  }

  function slider(id, name, { min, max, value }, says, act) {
    const input = make('input', { type: 'range', id, min, max, step: STEP, value: String(value) });
    const said = make('span', { class: 'said', id: `${id}-said` });
    const show = () => {
      said.textContent = says();
      input.setAttribute('aria-valuetext', says());
    };
    input.addEventListener('input', () => {
      act(Number(input.value));
      show();
    });
    show();
    return make('p', { class: 'pair' }, make('label', { for: id, text: name }), input, said);
  }

  const saidLength = () => {
    const { length, isLaid } = reading.bar();
    return isLaid ? `${words.um(length)}: d = ${words.um(reading.byEye())}` : 'not laid yet';
  };
  const saidPlace = () => `at ${words.um(reading.bar().place)}`;

  /** Return the form of the bar for the trace that is open; what has been noted stands. */
  function form(lesson, known) {
    const { law, end } = reading.current();
    if (lessons.revealed(known)) return null;
    if (law in known.read) {
      const left = lawsOf(lesson).filter((each) => !(each in known.read)).length;
      const next = left ? ` ${left === 1 ? 'One trace is' : 'Two traces are'} left.` : '';
      return make('p', { id: 'reading-said', html: `You read ${words.um(known.read[law])}.${next}` });
    }
    const { place, length } = reading.bar();
    const places = { min: 0, max: end, value: place };
    const sizes = { min: reading.SHORTEST, max: reading.LONGEST, value: length };
    const element = make('form', { id: 'reading-form', novalidate: true });
    element.append(
      make(
        'fieldset',
        {},
        make('legend', { text: 'By eye: lay the bar beside one bump, from its foot to its foot.' }),
        slider('reading-place', 'along', places, saidPlace, (at) => reading.lay({ place: at })),
        slider('reading-length', 'length', sizes, saidLength, (wide) => reading.lay({ length: wide })),
      ),
      make('div', { class: 'lesson-buttons' }, make('button', { type: 'submit', text: 'Note my reading' })),
      make('p', { class: 'lesson-verdict', role: 'status' }),
    );
    return element;
  }

  /* A drag on the picture moves the sliders too. */
  function follow() {
    const bar = reading.law && reading.bar();
    for (const [id, name, says] of [
      ['reading-place', 'place', saidPlace],
      ['reading-length', 'length', saidLength],
    ]) {
      const input = document.getElementById(id);
      if (!input || document.activeElement === input) continue;
      input.value = String(bar[name]);
      input.setAttribute('aria-valuetext', says());
      document.getElementById(`${id}-said`).textContent = says();
    }
  }

  /** Take the reading by eye; return why it cannot be taken, if so. */
  function note(lesson, known) {
    if (!reading.bar().isLaid) return 'Stretch the bar first.';
    known.read[reading.current().law] = reading.byEye();
    unveil(known);
    return '';
  }

  /** Return where the focus goes after a reading: to the next trace, or to the question what is seen. */
  function next(lesson, known) {
    const left = lawsOf(lesson).findIndex((law) => !(law in known.read));
    return left < 0 ? 'input[name="observation"]' : `[data-run="${left}"]`;
  }

  const interval = ({ interval: [low, high] }) => `${words.say3(low)} to ${words.say3(high)}`;

  /** Return the table of all readings so far, a column for each trace. */
  function table(lesson, known) {
    const cells = (law) => {
      const level = known.step >= STEPS.run ? levelOf(law, known) : LEVELS.trace;
      const { half, found, diameter } = reading.of(law);
      const eye = known.read[law];
      const read = [words.say3(reading.byLag(half)), `${words.say3(found.diameter)}<br>(${interval(found)})`];
      return [
        eye === undefined ? '–' : words.say3(eye),
        ...(level >= LEVELS.readings ? read : ['–', '–']),
        level >= LEVELS.truth ? `<strong>${words.say3(diameter)}</strong>` : '',
      ];
    };
    const columns = lawsOf(lesson).map(cells);
    const rows = lesson.experiment.table.slice(0, lessons.revealed(known) ? 4 : 3).map(({ label, way }, i) => {
      const cell = (column, j) => make('td', { 'data-read': `${lawOf(lesson, j)} ${way}`, html: column[i] });
      const each = columns.map(cell);
      return make('tr', {}, make('th', { scope: 'row', html: label }), ...each);
    });
    const named = ({ label, law }) => (lessons.revealed(known) ? `${label}: ${law}` : label);
    const head = ['diameter, µm', ...lesson.experiment.runs.map(named)];
    return lessons.page.grid(head, rows);
  }

  rub.on('reading', follow);
  lessons.reading = { open, unveil, form, note, next, table, isDone };
})();
