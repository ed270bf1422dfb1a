'use strict';
/* The slider m x'' + c x' + k x = F over one tick, exact for a force that is a parabola between ticks. */
(() => {
  const rub = (globalThis.rub ??= {});

  /** Return e^(-at) cosh(st) and e^(-at) sinh(st)/s, s^2 = a^2 - k/m, of the free motion; s may be imaginary. */
  function freeMotion(rate, square, time) {
    if (Math.abs(square) * time * time < 1e-10) {
      const decay = Math.exp(-rate * time);
      return [decay * (1 + (square * time * time) / 2), decay * time * (1 + (square * time * time) / 6)];
    }
    if (square < 0) {
      const turn = Math.sqrt(-square);
      const decay = Math.exp(-rate * time);
      return [decay * Math.cos(turn * time), (decay * Math.sin(turn * time)) / turn];
    }
    const root = Math.sqrt(square);
    const slow = Math.exp((root - rate) * time);
    const fast = Math.exp(-(root + rate) * time);
    return [0.5 * (slow + fast), (0.5 * (slow - fast)) / root];
  }

  /**
   * Return the constants of a step: free motion, and what the bulge 6 y (1 - y) of the force over a tick adds. At ticks
   * h/d = 0.02 apart the parabola leaves some 1e-7 of the largest motion, as tests hold beside the Python package.
   */
  function propagator({ mass, stiffness, damping }, time) {
    const rate = damping / (2 * mass);
    const own = stiffness / mass;
    const [even, odd] = freeMotion(rate, rate * rate - own, time);
    const p = {
      xx: even + rate * odd,
      xv: odd,
      vx: -own * odd,
      vv: even - rate * odd,
      time,
      damping,
      stiffness,
      x: 0,
      v: 0,
    };
    const { nodes, weights } = rub.numbers.panels([0, 0.5, 1], 16);
    nodes.forEach((y, i) => {
      const [still, moved] = freeMotion(rate, rate * rate - own, time * (1 - y));
      const bulge = (6 * y * (1 - y) * weights[i] * time) / mass;
      p.x += bulge * moved;
      p.v += bulge * (still - rate * moved);
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
})();
