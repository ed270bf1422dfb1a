/* A slider that rests on its load: m z'' + c z' + (W/s0) z = W eps, eps the area over its mean less 1 at constant gap.
 * What it bears is P = W + m z'' + c z', and the friction force is as P. First order in z/s0, as in `rubnoise theory`.
 */
const HARDNESS = 1000; // MPa: W = H A
const SCALE = 0.5; // um, the height scale of a world that does not say its own
const MASS = 0.005; // kg
const RATIO = 0.05;

/** Return the oscillator of a world: s0 in um, weight (uN), stiffness (N/m), damping (N s/m), resonance (rad/s). */
function of({ meanArea, heights: scale = SCALE }) {
  const weight = HARDNESS * meanArea;
  const stiffness = weight / scale;
  const resonance = Math.sqrt(stiffness / MASS);
  return { scale, weight, mass: MASS, stiffness, resonance, damping: 2 * RATIO * resonance * MASS };
}

/** Return |P/W - 1|^2 over |eps|^2 and |z|^2 over |eps|^2 in um^2 at a wavenumber; 1 and 0 at constant gap. */
function gains(world) {
  if (world.support !== 'load') return { load: () => 1, rise: () => 0 };
  const { resonance, scale } = of(world);
  const parts = (k) => {
    const w = k * world.speed;
    const loss = (2 * RATIO * resonance * w) ** 2;
    return { w, loss, below: (resonance ** 2 - w * w) ** 2 + loss };
  };
  return {
    load: (k) => (({ w, loss, below }) => (w ** 4 + loss) / below)(parts(k)),
    rise: (k) => (scale ** 2 * resonance ** 4) / parts(k).below,
  };
}

/** Return a function that takes areas at both ends of a tick and over it; it returns P/W at its end and over it. */
function follower(world, areaMean, time, state) {
  const { scale, weight, mass, stiffness, damping } = of(world);
  const constants = rub.slider.propagator({ mass, stiffness, damping }, time);
  return (before, area, mean) => {
    const [z, speed] = state;
    const forces = [before, area, mean].map((each) => weight * (each / areaMean - 1));
    rub.slider.step(constants, state, ...forces);
    const over = (mass * (state[1] - speed) + damping * (state[0] - z)) / (time * weight);
    return [area / areaMean - state[0] / scale, 1 + over];
  };
}

rub.load = { of, gains, follower, SCALE };
