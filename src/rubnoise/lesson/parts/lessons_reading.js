/* The lesson that reads a size off a trace: the form of the bar, and the table of what was read in three ways. */
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

/* What of the bar can be set, and how it is said. */
const SLIDERS = [
  { id: 'reading-place', key: 'place', name: 'along', says: ({ place }) => `at ${words.um(place)}` },
  { id: 'reading-length', key: 'length', name: 'length', says: saidLength },
];

function saidLength({ length, isLaid }) {
  return isLaid ? `${words.um(length)}: d = ${words.um(reading.byEye())}` : 'not laid yet';
}

function slider({ id, key, name }) {
  const [min, max] = key === 'place' ? [0, reading.current().end] : [reading.SHORTEST, reading.LONGEST];
  const oninput = (event) => reading.lay({ [key]: Number(event.target.value) });
  const input = make('input', { type: 'range', id, min, max, step: STEP, oninput });
  return make('p', { class: 'pair' }, make('label', { for: id, text: name }), input, make('span', { class: 'said' }));
}

/** Return the form of the bar for the trace that is open; what has been noted stands. */
function form(lesson, known) {
  const { law } = reading.current();
  if (lessons.revealed(known)) return null;
  if (law in known.read) {
    const left = lawsOf(lesson).filter((each) => !(each in known.read)).length;
    const next = left ? ` ${left === 1 ? 'One trace is' : 'Two traces are'} left.` : '';
    return make('p', { id: 'reading-said', html: `You read ${words.um(known.read[law])}.${next}` });
  }
  const legend = make('legend', { text: 'By eye: lay the bar beside one bump, from its foot to its foot.' });
  return make(
    'form',
    { id: 'reading-form', novalidate: true },
    make('fieldset', {}, legend, ...SLIDERS.map(slider)),
    make('div', { class: 'lesson-buttons' }, make('button', { type: 'submit', text: 'Note my reading' })),
    make('p', { class: 'lesson-verdict', role: 'status' }),
  );
}

/* A drag on the picture moves the sliders too. */
function follow() {
  for (const { id, key, says } of SLIDERS) {
    const input = document.getElementById(id);
    if (!input) continue;
    const bar = reading.bar();
    if (document.activeElement !== input) input.value = bar[key];
    input.setAttribute('aria-valuetext', says(bar));
    input.nextElementSibling.textContent = says(bar);
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
