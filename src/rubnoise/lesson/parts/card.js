/* One junction's life: its row, its numbers, its curve. */
const { ink, picture, said } = rub.plot;
const POINTS = 80; // of a curve
const card = {};

/** Choose a junction by its row number; -1 chooses none. */
rub.select = (id) => {
  const known = rub.run.rows.some((row) => row.id === id);
  rub.run.selected = known ? id : -1;
  card.write();
  card.status.textContent = known ? `junction ${id}: diameter ${said(rub.run.rows[id].diameter, 6)} µm` : '';
  rub.emit('select', known ? rub.run.rows[id] : null);
};

/** Choose the next live junction after the one that is chosen, or the one before. */
card.move = (step) => {
  const { living } = rub.run;
  if (rub.run.flight || !living.length) return;
  const at = living.findIndex((row) => row.id === rub.run.selected);
  rub.select(living[at < 0 ? 0 : (at + step + living.length) % living.length].id);
};

const chosen = () => rub.run.rows[rub.run.selected];

const halfOf = (row) => rub.halfLife(row.diameter, row.offset);

/** Return the area of a row at an age, in um^2. */
const areaAt = (row, age) => rub.run.trace.pulse.area(age, row.diameter, row.offset);

/** Return the mean area of a row over its life, in um^2. */
function meanArea(row) {
  const { pulse } = rub.run.trace;
  if (!pulse.between) return pulse.lifeMean * row.diameter ** 2;
  const life = 2 * halfOf(row);
  const edges = rub.numbers.evenly(0, life, 64);
  return edges.slice(1).reduce((sum, to, i) => sum + pulse.between(edges[i], to, row.diameter, row.offset), 0) / life;
}

/** Return the numbers of a row as label, value and unit. */
function numbersOf(row) {
  const { distance } = rub.run;
  const numbers = [
    ['row', String(row.id), ''],
    ['born at', said(row.birth, 6), 'µm'],
    ['dies at', said(row.death, 6), 'µm'],
    ['diameter', said(row.diameter, 6), 'µm'],
    ['life', said(2 * halfOf(row), 6), 'µm'],
    ['largest area', said(areaAt(row, halfOf(row)), 6), 'µm²'],
    ['mean area', said(meanArea(row), 6), 'µm²'],
    ['area now', said(areaAt(row, distance - row.birth), 6), 'µm²'],
  ];
  if (row.offset) numbers.splice(4, 0, ['misses the centre by', said(Math.abs(row.offset), 6), 'µm']);
  return numbers.filter(([label]) => label !== 'mean area' || !rub.readout.veiled());
}

/** Write the numbers of the chosen junction. */
card.write = () => {
  const row = chosen();
  card.panel.hidden = !row;
  card.hint.hidden = Boolean(row);
  if (!row) return;
  const cells = numbersOf(row).map(([label, value, unit]) => `<dt>${label}</dt><dd>${value} ${unit}</dd>`);
  card.list.innerHTML = cells.join('');
  card.picture.fit();
  card.picture.redraw();
};

/** Draw the curve of the chosen life, and where on it the junction is. */
function draw(p) {
  const row = chosen();
  if (!row) return;
  p.frame(40);
  const life = 2 * halfOf(row);
  const top = 1.1 * Math.max(rub.stage.largest(), 0.25 * Math.PI * row.diameter ** 2);
  p.axes([0, top, 'area of this junction, µm²'], [0, life, 'distance since birth, µm']);
  const along = (i) => (i / POINTS) * life;
  const y = (i) => p.y(areaAt(row, along(i)));
  p.curve(0, POINTS, (i) => p.x(along(i)), y, { colour: ink.accent, width: 2 });
  const age = rub.run.distance - row.birth;
  if (age >= 0 && age <= life) p.dot(p.x(age), p.y(areaAt(row, age)), ink.ink, 4.5);
}

/** Keep the area that changes from moment to moment up to date. */
card.refresh = () => {
  const row = chosen();
  if (!row) return;
  const cells = card.list.querySelectorAll('dd');
  cells[cells.length - 1].textContent = `${said(areaAt(row, rub.run.distance - row.birth), 6)} µm²`;
};

const find = (id) => document.getElementById(id);
const panel = find('card');
Object.assign(card, { panel, hint: find('card-hint'), status: find('status'), list: panel.querySelector('dl') });
card.picture = picture('card-canvas', draw);
rub.card = card;
