/* The slider from the side: a mass on a spring, pulled along by the surface that the drive moves to the right. */
const { ink, picture } = rub.plot;
const COILS = 14;
const MARKS = 36; // pixels between two marks of the surface
const PHASES = ['slides', 'stuck', 'runs back over the surface'];

/** Return the displacement in um, the way of the drive in um, and the phase. */
function now() {
  const { motion, time, trace, ticksSeen, distance } = rub.run;
  if (motion) return [motion.at('displacement', time), rub.world.speed * time, motion.phaseAt(time)];
  return [trace.displacement[ticksSeen], distance, 0];
}

/** Draw the slider as it is now; it and the surface move on one scale. */
picture('mass', (p) => {
  const [place, way, phase] = now();
  const [low, high] = rub.traces.reach();
  const scale = (0.7 * p.width) / (high - low);
  const x = 0.16 * p.width + (Math.min(Math.max(place, low), high) - low) * scale;
  const floor = p.height - 14;
  drawSurface(p, floor, way * scale);
  drawSpring(p, x, floor - 16);
  drawBlock(p, x, floor, phase === 1);
  p.heading(rub.run.motion ? PHASES[phase] : '', { left: Math.min(x + 30, p.width - 70), top: floor - 8 });
});

function drawSurface(p, floor, shift) {
  const lines = [[[0, floor], [p.width, floor]]];
  for (let x = (shift % MARKS) - MARKS; x < p.width; x += MARKS) lines.push([[x, floor], [x - 6, floor + 9]]);
  p.lines(lines, { colour: ink.second, width: 2 });
}

function drawSpring(p, x, y) {
  const end = x - 22;
  const coils = Array.from({ length: COILS - 1 }, (_, i) => [4 + ((end - 4) * (i + 1)) / COILS, y + (i % 2 ? 6 : -6)]);
  const wall = [[4, y - 18], [4, y + 14]];
  p.lines([wall, [[4, y], ...coils, [end, y]]], { colour: ink.quiet });
}

/* A stuck slider is filled and has teeth, so that you can see it without colour. */
function drawBlock(p, x, floor, isStuck) {
  const [left, right, top, bottom] = [x - 22, x + 22, floor - 30, floor - 2];
  p.shade(left, right, isStuck ? ink.second : ink.ground, { top, bottom });
  p.stroke((ctx) => ctx.rect(left, top, right - left, bottom - top), { width: 2 });
  if (!isStuck) return;
  const teeth = [-18, -12, -6, 0, 6, 12, 18].map((at) => [[x + at, floor - 3], [x + at, floor + 4]]);
  p.lines(teeth, { width: 2 });
}
