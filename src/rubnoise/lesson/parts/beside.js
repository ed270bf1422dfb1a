/* The contacts of a lesson beside each other on equal axes, each as far as it was run: area, births, how often. */
const { ink, picture } = rub.plot;
const COLUMNS = 480; // of a picture
const LOOK = 8; // columns from one look for the histogram to the next
const BINS = 40;
const LIVES = 4; // of the longer ones, in a picture
const LEAST_GAP = 2; // pixels between two births that can be distinguished
const beside = { runs: [], sides: [] };

/** A contact that slides along: its areas in the columns on show, its births there, and how often each area was. */
class Side {
  constructor(world, spacing, top) {
    Object.assign(this, { spacing, top, source: new rub.model.Births({ ...world }) });
    Object.assign(this, { coming: [], live: [], births: [], next: 0, looks: 0, reached: 0 });
    this.areas = new Float64Array(COLUMNS + 1);
    this.counts = new Float64Array(BINS);
  }

  /** Go on to a distance; of columns that have left the picture by then only some are looked at. */
  until(distance) {
    this.reached = distance;
    const last = Math.floor(distance / this.spacing);
    for (; this.next <= last; this.next += 1) {
      const isLook = this.next % LOOK === 0;
      if (isLook || this.next >= last - COLUMNS) this.column(isLook);
    }
  }

  column(isLook) {
    const place = this.next * this.spacing;
    this.meet(place);
    const { area } = this.source.contact.pulse;
    const sum = this.live.reduce((total, row) => total + area(place - row.birth, row.diameter, row.offset), 0);
    this.areas[this.next % this.areas.length] = sum;
    if (!isLook) return;
    this.looks += 1;
    this.counts[Math.min(BINS - 1, Math.floor((BINS * sum) / this.top))] += 1;
  }

  /* Rows are forgotten as soon as they are out of sight: a long run has hundreds of thousands. */
  meet(place) {
    this.source.until(place, this.coming);
    const begin = place - COLUMNS * this.spacing;
    for (const row of this.coming) if (row.birth > 0) this.births.push(row.birth);
    this.live = [...this.live, ...this.coming].filter((row) => row.death > place);
    this.coming = [];
    if (this.births.length && this.births[0] < begin) this.births = this.births.filter((birth) => birth >= begin);
  }

  /** Return the area in a column that is on show, in um^2. */
  area(column) {
    return this.areas[column % this.areas.length];
  }
}

/** Return the settings of a run of the open lesson, with the knobs that it leaves alone. */
const worldOf = (run) => ({ ...rub.world, ...run.set });

/** Show runs beside each other: {label, set, pressed, running}; those not pressed yet keep their place. */
beside.show = (runs) => {
  Object.assign(beside, { runs });
};

/** Make the contacts anew that have other settings than before; the others stay as far as they were run. */
function renew() {
  const worlds = beside.runs.map(worldOf);
  const key = JSON.stringify(worlds);
  if (key !== beside.key) {
    const exact = worlds.map((world) => rub.theory.exact(world));
    const spacing = (LIVES * Math.max(...exact.map((each) => each.lifeMean))) / COLUMNS;
    const top = Math.max(...exact.map((each) => rub.traces.topOf(each)));
    Object.assign(beside, { key, spacing, top, sides: worlds.map(() => null) });
  }
  beside.runs.forEach((run, i) => {
    if (run.pressed && !(run.running && wentBack(beside.sides[i]))) beside.sides[i] ??= sideOf(run);
    else beside.sides[i] = run.pressed ? sideOf(run) : null;
  });
}

const sideOf = (run) => new Side(worldOf(run), beside.spacing, beside.top);
const wentBack = (side) => side && side.reached > rub.run.reached;

/** Draw every contact in a part of the canvas, with the same axes; that of the run on the stage goes on. */
function draw(p) {
  if (!beside.runs.length) return;
  renew();
  const part = p.width / beside.runs.length;
  beside.sides.forEach((side, i) => {
    if (side && beside.runs[i].running) side.until(rub.run.reached);
    p.frame(i * part + 46, p.width - (i + 1) * part + 10);
    drawSide(p, side, beside.runs[i].label);
  });
}

function drawSide(p, side, label) {
  const { box } = p;
  const trace = { ...box, right: box.right - 0.16 * (box.right - box.left) };
  const { spacing, top } = beside;
  const last = side ? Math.floor(side.reached / spacing) : 0;
  const first = Math.max(0, last - COLUMNS);
  p.up(0, top, [`${label}: area, µm²`, label]);
  p.across(first * spacing, (first + COLUMNS) * spacing, ['sliding distance, µm', 'µm'], trace);
  const [x, y] = [0.5 * (box.left + box.right), 0.5 * (box.top + box.bottom)];
  if (!side) return p.text('press ▶', x, y, 'center', 'top', ink.quiet);
  drawBirths(p, side, trace);
  const area = (i) => p.y(Math.min(side.area(i), top));
  p.curve(first, last, (i) => p.x(i * spacing), area);
  return drawOften(p, side, trace.right + 4);
}

/** Mark each birth at the lower edge, where single ones can be seen. */
function drawBirths(p, { births, source, reached }, { left, bottom }) {
  if (p.x(source.contact.spacing) - p.x(0) < LEAST_GAP) return;
  for (const x of births.filter((birth) => birth <= reached).map(p.x))
    if (x >= left) p.shade(x - 0.5, x + 0.7, ink.birth, { top: bottom - 9, bottom });
}

function drawOften(p, { counts, looks, top }, left) {
  const most = Math.max(...counts);
  p.ctx.globalAlpha = 0.6;
  for (let i = 0; looks && i < BINS; i += 1) {
    const [low, high] = [p.y((i * top) / BINS) - 0.5, p.y(((i + 1) * top) / BINS)];
    p.shade(left, left + (counts[i] / most) * (p.box.right - left), ink.quiet, { top: high, bottom: low });
  }
  p.ctx.globalAlpha = 1;
}

beside.picture = picture('beside', draw);
rub.beside = beside;
