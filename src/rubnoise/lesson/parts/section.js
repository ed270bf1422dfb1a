/* The same from the side: a cut through both surfaces along the dotted line of the stage, and the hills that meet. */
const { ink, picture, colourOf } = rub.plot;
const STEP = 2; // pixels
const FLANK = 0.3; // of a diameter, from a hill's flat top down to its foot
const APART = 3; // pixels between the middle and a top that touches nothing
const TITLES = ['from the side, cut along the dotted line: tops that meet are junctions', 'from the side'];
const section = {};

/** Return half of the chord that a cut so far from the centre has in a circle; 0 where it misses. */
const halfChord = (diameter, away) => 0.5 * Math.sqrt(Math.max(0, diameter ** 2 - 4 * away ** 2));

/**
 * Return the hills that the cut meets: their middles below and above, half of each flat top (0 where the cut misses
 * that hill), flank, all in pixels.
 */
function hills() {
  const { stage, run } = rub;
  return stage.pairs().flatMap((row) => {
    const [x, y] = stage.placeOf(row);
    const [away, across] = [y - stage.cut(), 0.5 * row.offset];
    const [halfBelow, halfAbove] = [away - across, away + across].map((each) => halfChord(row.diameter, each));
    if (!(halfBelow || halfAbove)) return [];
    const apart = 0.5 * stage.along(row);
    const lengths = { below: x - apart, above: x + apart, halfBelow, halfAbove, flank: FLANK * row.diameter };
    const part = run.trace.pulse.area(run.distance - row.birth, row.diameter, row.offset) / stage.largest();
    return [{ ...inPixels(lengths, stage.scale), part }];
  });
}

const inPixels = (lengths, scale) =>
  Object.fromEntries(Object.entries(lengths).map(([name, length]) => [name, length * scale]));

/* Low waves that nothing touches; the upper ones move with the drive. */
const wave = (x) => 0.12 + 0.05 * Math.sin(x / 17) + 0.05 * Math.sin(x / 7.3);

/** Return how high a surface is at every other pixel, 0 at its foot and 1 at a top. */
function heights(width, all, side, shift) {
  const found = Float64Array.from({ length: Math.ceil(width / STEP) + 1 }, (_, i) => wave(i * STEP - shift));
  for (const { [side]: middle, [side === 'below' ? 'halfBelow' : 'halfAbove']: half, flank } of all) {
    if (!half) continue;
    const last = Math.min(found.length - 1, Math.floor((middle + half + flank) / STEP));
    for (let i = Math.max(0, Math.ceil((middle - half - flank) / STEP)); i <= last; i += 1) {
      const out = Math.max(0, (Math.abs(i * STEP - middle) - half) / flank);
      found[i] = Math.max(found[i], (1 - Math.min(1, out)) ** 0.7);
    }
  }
  return found;
}

/** Draw both surfaces, and in the colours of the stage where they touch. */
function draw(p) {
  const { width, height: high } = p;
  const top = 18;
  const middle = 0.5 * (top + high);
  const all = hills();
  const foot = 0.5 * (high - top) - 8;
  const shift = rub.run.distance * rub.stage.scale;
  const below = heights(width, all, 'below', 0);
  const above = heights(width, all, 'above', shift);
  p.ground(high - 1, (x) => middle + APART + foot * (1 - (below[x / STEP] ?? 0)), ink.quiet, STEP);
  p.ground(top, (x) => middle - APART - foot * (1 - (above[x / STEP] ?? 0)), ink.second, STEP);
  for (const hill of all) touch(p, hill, middle);
  p.heading(TITLES, { left: 0, top, right: width });
}

function touch(p, { below, above, halfBelow, halfAbove, part }, middle) {
  const left = Math.max(below - halfBelow, above - halfAbove);
  const right = Math.min(below + halfBelow, above + halfAbove);
  if (right <= left || !halfBelow || !halfAbove) return;
  p.shade(left, right, colourOf(part), { top: middle - APART - 1, bottom: middle + APART + 1 });
}

section.picture = picture('section', draw);
section.hills = hills;
rub.section = section;
