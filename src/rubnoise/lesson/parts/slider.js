/* The slider m x'' + c x' + k x = F over one tick, exact for a force that is a parabola between ticks. */
/**
 * Return the constants of a step: free motion, and what the bulge 6 y (1 - y) of the force over a tick adds. At ticks
 * h/d = 0.02 apart the parabola leaves some 1e-7 of the largest motion, as tests hold beside the Python package.
 */
function propagator({ mass, stiffness, damping }, time) {
  const rate = damping / (2 * mass);
  const own = stiffness / mass;
  const after = (t) => rub.response(rate, own, t, new Float64Array(4));
  const [moved, speed] = after(time);
  const free = { xx: speed + 2 * rate * moved, xv: moved, vx: -own * moved, vv: speed };
  const p = { ...free, time, damping, stiffness, x: 0, v: 0 };
  const { nodes, weights } = rub.numbers.panels([0, 0.5, 1], 16);
  nodes.forEach((y, i) => {
    const bulge = (6 * y * (1 - y) * weights[i] * time) / mass;
    const [x, v] = after(time * (1 - y));
    p.x += bulge * x;
    p.v += bulge * v;
  });
  return p;
}

/** Move state = [x, x'] over one tick: force at both ends and its mean between them, in uN. */
function step(p, state, force, next, mean) {
  const slope = (next - force) / p.time;
  const drift = slope / p.stiffness;
  const rest = force / p.stiffness - (p.damping * drift) / p.stiffness;
  const bulge = mean - 0.5 * (force + next);
  const x = state[0] - rest;
  const v = state[1] - drift;
  state[0] = rest + drift * p.time + p.xx * x + p.xv * v + p.x * bulge;
  state[1] = drift + p.vx * x + p.vv * v + p.v * bulge;
}

rub.slider = { propagator, step };
