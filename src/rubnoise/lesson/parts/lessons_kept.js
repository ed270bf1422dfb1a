/* What each run of a lesson has shown stays: a column for each run, what these say about the question, and when to ask. */
const { lessons } = rub;
const { state, words, STEPS } = lessons;
const { make } = rub;
const SECONDS = 10; // of an experiment at its pace, before it asks what is seen
const FEWEST = 2; // lives
const ROUNDING = 1e-9;
const OTHER = 'other'; // the column of controls that fit no run
const laws = new Map();

/** Return the run that the settings are those of, or OTHER after a control was turned. */
function running({ experiment: { runs } }, known) {
  const set = runs[known.running]?.set;
  const fits = set && Object.entries(set).every(([key, value]) => rub.world[key] === value);
  return fits ? known.running : OTHER;
}

/** Return the lives that each run of a lesson goes on before it asks what is seen. */
lessons.lives = ({ experiment: { lives, pace } }) => lives ?? Math.max(FEWEST, Math.ceil(SECONDS * pace));

/** Return the lives of one step ahead: enough for the second digit of most figures, and for the question. */
lessons.ahead = ({ experiment }) => Math.max(200, experiment.lives ?? 0);

/** Return whether enough has been seen to say something: of all runs, of all traces. */
lessons.enough = (lesson, known) => {
  if (lesson.experiment.reading) return lessons.reading.isDone(lesson, known);
  const runs = Object.values(known.watched).filter((lives) => lives >= (1 - ROUNDING) * lessons.lives(lesson));
  return runs.length === lesson.experiment.runs.length;
};

/** Note how far the run that was pressed last has come; return whether that has just become enough. */
lessons.watch = (lesson, known) => {
  if (known.running < 0 || running(lesson, known) !== known.running) return false;
  const before = lessons.enough(lesson, known);
  const lives = rub.run.reached / rub.exact().lifeMean;
  known.watched[known.running] = Math.max(known.watched[known.running] ?? 0, lives);
  return !before && lessons.enough(lesson, known);
};

/** Return a figure of a row: one that is seen and the exact one have one formula, but where the row has two. */
const seenOf = (row, seen, exact, world) => (row.seen ?? row.value)(seen, exact, world);
const exactOf = (row, exact, world) => (row.exact ? row.exact(exact, world) : row.value(exact, exact, world));

/** Keep what the run on the stage shows. */
function keep(lesson, known, seen, exact) {
  if (known.step < STEPS.run) return;
  const column = running(lesson, known);
  known.kept[column] = lesson.experiment.table.map((row) => seenOf(row, seen, exact, rub.world));
  known.lives[column] = rub.run.reached / exact.lifeMean;
}

/** Return the law's figures for a run, or for the settings as they are. */
function lawOf({ experiment: { runs, table } }, column) {
  const world = { ...rub.world, ...runs[column]?.set };
  const key = JSON.stringify([state.open, world]);
  const exact = laws.has(key) ? null : rub.theory.exact(world);
  if (exact) laws.set(key, Array.from(table, (row) => exactOf(row, exact, world)));
  return laws.get(key);
}

/** Return the columns of a lesson's table: its runs, and the controls as they are if those fit none. */
function columns(lesson, known) {
  const runs = lesson.experiment.runs.map((run, i) => ({ key: i, label: run.label }));
  const isOther = known.step >= STEPS.run && running(lesson, known) === OTHER;
  return isOther ? [...runs, { key: OTHER, label: 'controls as they are' }] : runs;
}

const heading = (html) => make('th', { scope: 'row', html });
const cells = (name, shown, i) => shown.map(({ key }) => make('td', { [`data-${name}`]: `${key}.${i}` }));

/** Return the table of what the runs have shown; the law's figures wait until they give no answer away. */
function table(lesson, known) {
  const shown = columns(lesson, known);
  const open = lessons.revealed(known);
  const isSingle = shown.length === 1;
  const labels = isSingle ? ['seen', ...(open ? ['the law'] : [])] : shown.map(({ label }) => label);
  const body = lesson.experiment.table.flatMap((row, i) => {
    const seen = cells('seen', shown, i);
    const law = open ? cells('exact', shown, i) : [];
    const name = heading(row.label + (row.unit ? `, ${words.unitName(row.unit)}` : ''));
    if (isSingle || !open) return [make('tr', {}, name, ...seen, ...law)];
    return [make('tr', {}, name, ...seen), make('tr', { class: 'law' }, heading('the law'), ...law)];
  });
  return lessons.page.grid(['quantity', ...labels], body, { class: 'lesson-table', 'data-columns': shown.length });
}

/** Write the figures into the table on show. */
function write(root, lesson, known) {
  for (const { key } of columns(lesson, known)) {
    const kept = known.kept[key];
    const law = lawOf(lesson, key);
    lesson.experiment.table.forEach((row, i) => {
      const put = (name, text) => {
        const element = root.querySelector(`[data-${name}="${key}.${i}"]`);
        if (element && element.textContent !== text) element.textContent = text;
      };
      const chance = kept && row.chance ? ` ± ${row.chance(known.lives[key] || 1).toPrecision(1)}` : '';
      put('seen', kept ? words.say(kept[i]) + chance : '–');
      put('exact', words.say(law[i]));
    });
  }
}

/** Return the option that is nearest to a figure, on a scale of factors. */
const nearest = (options, figure) =>
  options.reduce((best, each) =>
    Math.abs(Math.log(each.value / figure)) < Math.abs(Math.log(best.value / figure)) ? each : best,
  );

/** Return the option that the kept figures speak for; undefined before all of them are there. */
function spoken(lesson, known) {
  const { run, row, says } = lesson.evidence;
  if (!(run in known.kept)) return undefined;
  const { options } = lesson.prediction;
  if (!says) return nearest(options, known.kept[run][row]);
  const id = says(known.kept, known.lives[run] || 1);
  return options.find((each) => each.id === id);
}

/** Return in words what the table says about an observation. */
function answer(lesson, known, option) {
  const says = lesson.evidence && spoken(lesson, known);
  if (!says) return '';
  const { run, row } = lesson.evidence;
  const { runs, table: rows } = lesson.experiment;
  const where = `the row “${rows[row].label}”${runs.length > 1 ? `, column “${runs[run].label}”,` : ''}`;
  const told = `${where} shows ${words.withUnit(known.kept[run][row], rows[row].unit)}`;
  const said = says === option ? `So does the table: ${told}.` : `The table says ${says.text}: ${told}.`;
  return says.right ? said : `${said} This run was short; over many lives it comes to the law.`;
}

lessons.kept = { keep, table, write, spoken, answer, nearest, columns };
