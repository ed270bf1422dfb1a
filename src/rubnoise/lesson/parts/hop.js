/* A slider that hops, from the side: hills that pass under its foot, and how high the foot was on the way. */
const { ink, picture } = rub.plot;
const REACH = 5; // of c, to either side of the foot
const LOW = -3; // of s0: the lowest that the stage shows
const HIGH = 6;
const LEG = 84; // pixels: longer than most hills are high, so that only the foot meets them
const TOP = 22; // pixels for the title
const SHOWN = 16; // of c, in the trace
const TITLES = ['hills pass to the right under the foot of the slider; filled: what it touches', 'hills and slider'];

/** Draw the stage: hills that the drive moves to the right, and the slider on its foot. */
function stage(p) {
  const { width, height } = p;
  const { flight, distance } = rub.run;
  const scale = width / (2 * REACH);
  p.x = (off) => 0.5 * width - off * scale;
  const z = flight.heightAt(distance);
  const high = Math.max(HIGH, z + 4.5);
  p.y = (level) => TOP + ((high - level) / (high - LOW)) * (height - TOP);
  const hills = near(flight, distance / flight.length);
  ground(p, scale, hills);
  for (const hill of hills) if (hill.top - hill.off ** 2 > z) touched(p, hill, z);
  body(p, p.x(0), p.y(z), Math.min(0.2 * width, 90));
  p.heading(TITLES, { left: 8, top: TOP, right: width });
}

/** Return the summits that are seen: how far ahead of the foot they are, in c, and how high, in s0. */
function near(flight, place) {
  const { summits } = flight;
  const [first, last] = summits.between(place - rub.flight.SIDE, place + rub.flight.SIDE);
  const found = [];
  for (let i = first; i < last; i += 1) {
    const [off, top] = [summits.place.values[i] - place, summits.height.values[i]];
    if (top > LOW && Math.abs(off) < REACH + Math.sqrt(top - LOW)) found.push({ off, top });
  }
  return found;
}

function ground(p, scale, hills) {
  const { width, height } = p;
  const levels = new Float64Array(Math.ceil(width) + 1).fill(LOW);
  for (const { off, top } of hills) {
    const half = Math.sqrt(top - LOW) * scale;
    const last = Math.min(levels.length - 1, Math.floor(p.x(off) + half));
    for (let i = Math.max(0, Math.ceil(p.x(off) - half)); i <= last; i += 1)
      levels[i] = Math.max(levels[i], top - ((i - p.x(off)) / scale) ** 2);
  }
  p.ground(height, (i) => p.y(levels[i] ?? LOW), ink.quiet);
}

/** Fill the part of a hill that the foot has pressed in. */
function touched(p, { off, top }, z) {
  const half = Math.sqrt(top - z);
  p.fill((ctx) => {
    for (let i = -20; i <= 20; i += 1) ctx.lineTo(p.x(off + (half * i) / 20), p.y(top - (half * (i / 20)) ** 2));
  }, rub.plot.colourOf(Math.min(1, (top - off * off - z) / 3)));
}

function body(p, x, y, wide) {
  const colour = rub.run.flight.touchesAt(rub.run.distance) ? ink.second : ink.accent;
  p.stroke((ctx) => ctx.rect(x - 0.5 * wide, y - LEG - 24, wide, 24), { colour, width: 2 });
  p.fill((ctx) => [[-5, LEG], [0, 0], [5, LEG]].forEach(([away, up]) => ctx.lineTo(x + away, y - up)), colour);
}

/** Draw the trace of the separation, with flights shaded, as far as the run has come. */
function draw(p) {
  const { flight, distance } = rub.run;
  if (!flight) return;
  const { left } = p.frame(undefined, 10, 18, 20);
  const { place, z, touching } = flight.columns;
  const last = flight.at(distance);
  const from = Math.max(0, distance / flight.length - SHOWN);
  const first = Math.max(0, place.find(from));
  const [low, high] = [LOW * flight.height, topOf(z, first, last) * flight.height];
  const um = flight.length;
  const across = [from * um, (from + SHOWN) * um, 'sliding distance, µm'];
  p.axes([low, high, ['separation, µm; shaded: apart', 'separation, µm']], across);
  const x = (i) => Math.max(left, p.x(place.values[i] * um));
  for (let i = first; i < last; i += 1) {
    if (touching.values[i]) continue;
    const begun = i;
    while (i < last && !touching.values[i]) i += 1;
    p.shade(x(begun), Math.max(x(begun) + 1, x(i)), ink.stuck);
  }
  p.curve(first, last, x, (i) => p.y(z.values[i] * flight.height));
}

/* In steps, so that the axis stands still for a while. */
function topOf(z, first, last) {
  let top = HIGH;
  for (let i = first; i <= last; i += 1) while (z.values[i] > top) top *= 1.5;
  return top;
}

picture('hop', draw);
rub.hop = { stage };
