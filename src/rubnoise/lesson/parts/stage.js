/* The stage: two surfaces seen from above, one at rest, one sliding to the right, and the circles that meet. */
const { ink, picture, colourOf } = rub.plot;
const ROOMY = 9; // area of the stage over that of the circles that are alive on average
const FEW = 6; // junctions alive: so few that a line through the middle would miss most of them
const stage = { calm: false, scale: 1 };
let scale = 1; // pixels in a um
let wide = 1;
let high = 1;

const { placeOf } = rub.places;
const place = [0, 0];

/** Return how far the centres of a row are apart along the motion, negative before mid-life, in um. */
stage.along = (row) => rub.run.distance - row.birth - rub.halfLife(row.diameter, row.offset);

/** Measure the stage: how many um it shows. */
function measure() {
  const { countMean, contact } = rub.exact();
  const area = ROOMY * Math.max(6, countMean) * 0.25 * Math.PI * contact.diameter ** 2;
  scale = Math.sqrt((stage.picture.width * stage.picture.height) / area);
  stage.scale = scale;
  const [before, beforeHigh] = [wide, high];
  wide = stage.picture.width / scale;
  high = stage.picture.height / scale;
  if (wide !== before || high !== beforeHigh) rub.places.within(wide, high);
}

/** Draw both surfaces and every junction as it is now. */
function draw(p) {
  if (rub.run.flight) return rub.hop.stage(p);
  drawGrain(p);
  drawComing(p);
  for (const row of rub.run.living) drawJunction(p, row);
  drawGone(p);
  drawSelected(p);
  return drawCut(p);
}

/** Return where the cut of the side view goes, in um: through the chosen junction, one of few, or the middle. */
stage.cut = () => {
  const row = chosen() ?? (rub.exact().countMean < FEW ? rub.run.living[0] : undefined);
  return row ? placeOf(row, place)[1] : 0.5 * high;
};

function drawCut(p) {
  const edges = { left: 0, right: p.width };
  if (rub.section.picture.width) p.level(Math.round(stage.cut() * scale), { width: 1, dash: [2, 5] }, edges);
}

/** Return the rows whose circles are in view: alive, about to meet, or just parted. */
stage.pairs = () => {
  const { run } = rub;
  const reach = reachOf();
  const rows = run.rows.slice(run.after(run.distance - run.longest - reach), run.after(run.distance + reach));
  return rows.filter((row) => row.death + reach > run.distance);
};

/* A few strokes of either surface, so that the sliding is seen where nothing meets. */
function drawGrain(p) {
  const shift = (rub.run.distance * scale) % 48;
  const lines = [];
  for (let y = 10, row = 0; y < p.height; y += 22, row += 1) {
    const moves = row % 2 === 0;
    for (let x = -48 + ((row * 31) % 48) + (moves ? shift : 0); x < p.width; x += 48)
      lines.push([[x, y], [x + (moves ? 14 : 4), y]]);
  }
  p.lines(lines, { colour: ink.faint, width: 1 });
}

/** Draw the pair of circles of a row at the offset of their centres, in pixels of the page. */
function drawPair(p, row, offset) {
  placeOf(row, place);
  const [x, y, radius] = [place[0] * scale, place[1] * scale, 0.5 * row.diameter * scale];
  const [along, across] = [0.5 * offset * scale, 0.5 * row.offset * scale];
  p.circle(x - along, y - across, radius, { colour: ink.quiet, width: 1 });
  p.circle(x + along, y + across, radius, { colour: ink.second, width: 1 });
}

function drawJunction(p, row) {
  const { distance, trace } = rub.run;
  const offset = stage.along(row);
  const area = trace.pulse.area(distance - row.birth, row.diameter, row.offset);
  placeOf(row, place);
  const [x, y, radius] = [place[0] * scale, place[1] * scale, 0.5 * row.diameter * scale];
  p.fill((ctx) => stage.lens(ctx, x, y, radius, offset * scale, row.offset * scale), colourOf(area / largest()));
  drawPair(p, row, offset);
  const near = 0.15 * row.diameter;
  if (distance - row.birth < near || row.death - distance < near) mark(p, offset < 0);
}

/** Outline the overlap of two circles whose centres are so far apart, along the motion and across it. */
stage.lens = (ctx, x, y, radius, along, across) => {
  const half = Math.acos(Math.min(1, Math.hypot(along, across) / (2 * radius)));
  const turn = Math.atan2(across, along);
  ctx.arc(x - along / 2, y - across / 2, radius, turn - half, turn + half);
  ctx.arc(x + along / 2, y + across / 2, radius, turn + Math.PI - half, turn + Math.PI + half);
};

/* Births and deaths have a sign of their own beside the colour: a ring, and a cross. */
function mark(p, isBirth) {
  const [x, y] = [place[0] * scale, place[1] * scale];
  if (isBirth) return p.circle(x, y, 7, { colour: ink.birth, width: 2 });
  const cross = [1, -1].map((way) => [[x - 5, y - 5 * way], [x + 5, y + 5 * way]]);
  return p.lines(cross, { colour: ink.death, width: 2 });
}

const reachOf = () => 0.5 * rub.exact().contact.diameter;

/* Circles that are about to meet come into view, those that have parted fade. */
function drawFaint(p, row, away) {
  p.ctx.globalAlpha = 0.6 * (1 - away / reachOf());
  drawPair(p, row, stage.along(row));
  p.ctx.globalAlpha = 1;
}

function drawComing(p) {
  const { run } = rub;
  const rows = run.rows.slice(run.after(run.distance), run.after(run.distance + reachOf()));
  for (const row of rows) drawFaint(p, row, row.birth - run.distance);
}

function drawGone(p) {
  const { run } = rub;
  const rows = run.rows.slice(run.after(run.distance - run.longest - reachOf()), run.after(run.distance));
  const gone = rows.filter((row) => row.death <= run.distance && run.distance - row.death <= reachOf());
  for (const row of gone) drawFaint(p, row, run.distance - row.death);
}

const chosen = () => rub.run.living.find((each) => each.id === rub.run.selected);

function drawSelected(p) {
  const row = chosen();
  if (!row) return;
  placeOf(row, place);
  const half = (apart) => 0.5 * (Math.abs(apart) + row.diameter) * scale + 4;
  const [x, y] = place.map((each) => each * scale);
  const outline = (ctx) => ctx.ellipse(x, y, half(stage.along(row)), half(row.offset), 0, 0, 2 * Math.PI);
  p.stroke(outline, { colour: ink.accent, width: 3 });
}

/** Return the area in um^2 at the upper end of the colours: full overlap of a junction as large as few are. */
function largest() {
  const { mean, std } = rub.exact().contact.sizes;
  return 0.25 * Math.PI * (mean + 2 * std) ** 2;
}

/** Return the live row whose circles hold a point of the stage, the one whose middle is nearest; or null. */
stage.rowAt = (x, y) => {
  if (rub.run.flight) return null;
  let found = null;
  let least = Infinity;
  for (const row of rub.run.living) {
    placeOf(row, place);
    const away = Math.hypot(x / scale - place[0], y / scale - place[1]);
    if (away < least && away < Math.max(row.diameter, 14 / scale)) [found, least] = [row, away];
  }
  return found;
};

/** Return where a live row is on the stage, in pixels of the page from its upper left corner. */
stage.pointOf = (row) => placeOf(row, place).map((value) => value * scale * stage.picture.zoom);

/** Let a click choose a junction. */
stage.begin = () => {
  const { canvas } = stage.picture;
  rub.on('reset', () => rub.places.within(wide, high));
  canvas.addEventListener('click', (event) => {
    const box = canvas.getBoundingClientRect();
    const { zoom } = stage.picture;
    const row = stage.rowAt((event.clientX - box.left) / zoom, (event.clientY - box.top) / zoom);
    rub.select(row ? row.id : -1);
  });
  measure();
};

stage.picture = picture('stage', draw, { fitted: measure });
stage.placeOf = (row) => placeOf(row, [0, 0]);
stage.measure = measure;
stage.largest = largest;
rub.stage = stage;
