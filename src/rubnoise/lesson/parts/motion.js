'use strict';
/*
 * A slider that pushes back: m x'' + c x' + k x = G(s) sign(w), w = V - x', s = V t - (x - x_0). At w = 0, with
 * f = k x + c V: |f| <= G sticks, f > G goes forward, f < -G goes back. Static and kinetic friction are the same.
 *
 * From node to node of the field G is a straight line, and there the motion has a closed form, however stiff or damped:
 * with l the distance passed and u = |w|, l'' + 2 a l' + b l = P + Q t. So nothing depends on frames, and all that is
 * searched for is when l reaches the next node and whether u falls to 0 before. What errs is the broken line: the
 * displacement is right to some 1e-5 of itself over one slip.
 */
(() => {
  const rub = (globalThis.rub ??= {});
  const SLIP = 0;
  const STICK = 1;
  const REVERSAL = 2;
  const KINDS = ['stick', 'slip', 'reversal', 'forward'];
  const COLUMNS = ['time', 'displacement', 'velocity', 'force', 'farthest', 'phase'];
  const SUMS = ['sum', 'squares', 'velocitySquares', 'stuck']; // over time, of x, x^2, x'^2 and being stuck
  const MOST_SAMPLES = 1500000; // some 100 MB
  const ORDERS = 16;

  /** Return (e^y - 1)/y and (e^y - 1 - y)/y^2. */
  function growths(y) {
    if (Math.abs(y) < 0.5) {
      let second = 0;
      for (let n = ORDERS; n >= 2; n -= 1) second = (1 + y * second) / n;
      return [1 + y * second, second];
    }
    const first = Math.expm1(y) / y;
    return [first, (first - 1) / y];
  }

  /**
   * Return S, S', and the first and second integral of S after a time t, where S'' + 2 a S' + b S = 0, S(0) = 0 and
   * S'(0) = 1: all that a cell's motion is made of. b may be negative, and a t may be large.
   */
  function response(a, b, t, into) {
    const square = a * a - b;
    if (Math.abs(b) * t * t < 0.3 && 2 * a * t < 0.3) return series(a, b, t, into);
    if (square > 0 && square * t * t > 0.01) return exponentials(a, b, Math.sqrt(square), t, into);
    const turn = Math.sqrt(Math.abs(square));
    const angle = turn * t;
    const decay = Math.exp(-a * t);
    const odd = angle < 1e-4 ? t * (1 - (square < 0 ? 1 : -1) * (angle * angle) / 6) : square < 0 ? Math.sin(angle) / turn : Math.sinh(angle) / turn;
    const even = square < 0 ? Math.cos(angle) : Math.cosh(angle);
    into[0] = decay * odd;
    into[1] = decay * (even - a * odd);
    into[2] = (1 - into[1] - 2 * a * into[0]) / b;
    into[3] = (t - into[0] - 2 * a * into[2]) / b;
    return into;
  }

  function series(a, b, t, into) {
    let before = 1; // coefficients of t^n in S' and S
    let here = 0;
    into.fill(0);
    let power = 1;
    for (let n = 0; n < ORDERS; n += 1) {
      into[0] += here * power;
      into[1] += before * power;
      into[2] += (here * power * t) / (n + 1);
      into[3] += (here * power * t * t) / ((n + 1) * (n + 2));
      const next = before / (n + 1);
      before = (-2 * a * (n + 1) * next - b * here) / (n + 1);
      here = next;
      power *= t;
      if (Math.abs(here * power) + Math.abs(before * power * t) < 1e-18 * t) break;
    }
    return into;
  }

  /* Divided differences over both roots: that of the slow one may be 0, and nothing is lost. */
  function exponentials(a, b, root, t, into) {
    const slow = -b / (a + root);
    const fast = -(a + root);
    const [one, two] = [growths(slow * t), growths(fast * t)];
    const [low, high] = [Math.exp(slow * t), Math.exp(fast * t)];
    into[0] = (low - high) / (2 * root);
    into[1] = (slow * low - fast * high) / (2 * root);
    into[2] = (t * (one[0] - two[0])) / (2 * root);
    into[3] = (t * t * (one[1] - two[1])) / (2 * root);
    return into;
  }

  /** Return where a function that changes its sign between low and high is 0, by Newton's method kept in brackets. */
  function rootOf(value, slope, low, high, begin) {
    const rises = value(high) > 0;
    let t = begin > low && begin < high ? begin : 0.5 * (low + high);
    for (let turn = 0; turn < 80; turn += 1) {
      const y = value(t);
      if (y === 0) return t;
      if (y > 0 === rises) high = t;
      else low = t;
      const newton = t - y / slope(t);
      const next = newton > low && newton < high ? newton : 0.5 * (low + high);
      if (Math.abs(next - t) <= 1e-14 * high) return next;
      t = next;
    }
    return t;
  }

  /** One piece of slip: the motion from a place of a cell on, as long as G is one straight line. */
  class Piece {
    constructor() {
      this.now = new Float64Array(4);
      this.length = (t) => this.at(t)[2] * this.push + this.at(t)[3] * this.pull + this.at(t)[0] * this.speed;
      this.pace = (t) => this.at(t)[1] * this.speed + this.at(t)[0] * this.push + this.at(t)[2] * this.pull;
      this.gain = (t) => this.push + this.pull * t - 2 * this.rate * this.pace(t) - this.own * this.length(t);
      this.change = (t) => this.pull - 2 * this.rate * this.gain(t) - this.own * this.pace(t);
    }

    begin(rate, own, speed, push, pull) {
      Object.assign(this, { rate, own, speed, push, pull, known: -1 });
    }

    at(t) {
      if (t !== this.known) response(this.rate, this.own, t, this.now);
      this.known = t;
      return this.now;
    }

    /** Return a time to look at: about when a distance is passed, but never so long that u' could turn twice. */
    guess(distance) {
      const { speed, push, pull, rate, own } = this;
      let t = speed > 0 ? distance / speed : Infinity;
      const start = push - 2 * rate * speed;
      if (start > 0) t = Math.min(t, Math.sqrt((2 * distance) / start) + (2 * rate * distance) / push);
      if (start < 0) t = Math.max(t, Math.min(2 * t, (-1.2 * speed) / start));
      if (pull > 0) t = Math.min(Math.max(t, 0), (Math.cbrt((6 * distance) / pull) + Math.sqrt((4 * rate * distance) / pull)) * (start < 0 ? 3 : 1));
      const square = own - rate * rate;
      if (square > 0) t = Math.min(t, 3 / Math.sqrt(square));
      if (own < 0) t = Math.min(t, (3 * (rate + Math.sqrt(-square))) / -own);
      return t < 1e9 ? 1.05 * t : 1;
    }

    /** Return how long the piece lasts and how it ends: at the distance ("cell"), at u = 0 ("rest"), or before both. */
    end(distance) {
      const t = this.guess(distance);
      const rest = this.rest(t);
      const last = rest ?? t;
      if (this.length(last) < distance) return rest === null ? [t, 'on'] : [rest, 'rest'];
      const crossing = (time) => this.length(time) - distance;
      return [rootOf(crossing, this.pace, 0, last, distance / Math.max(this.speed, this.pace(last))), 'cell'];
    }

    /** Return the first time up to t at which u falls to 0, or null. */
    rest(t) {
      if (this.push - 2 * this.rate * this.speed < 0 && this.gain(t) > 0) {
        const lowest = rootOf(this.gain, this.change, 0, t, 0.5 * t);
        return this.pace(lowest) <= 0 ? rootOf(this.pace, this.gain, 0, lowest, 0.5 * lowest) : null;
      }
      return this.pace(t) <= 0 ? rootOf(this.pace, this.gain, 0, t, 0.5 * t) : null;
    }
  }

  /** The motion of a slider over a field, as far as it has been computed: a sample wherever it meets a node, or turns. */
  class Motion {
    constructor({ mass, stiffness, damping, speed }, field, start) {
      Object.assign(this, { mass, stiffness, damping, drive: speed, field, start });
      Object.assign(this, { time: 0, x: start, u: speed, way: 1, cell: 0, offset: 0, phase: SLIP });
      Object.assign(this, { isOver: false, reached: 0, pieces: 0, total: {} });
      for (const name of SUMS) this.total[name] = 0;
      this.range = { displacement: [start, start], velocity: [0, 0], force: [0, 0] };
      this.columns = Object.fromEntries(COLUMNS.map((name) => [name, new rub.Numbers()]));
      this.sums = Object.fromEntries(SUMS.map((name) => [name, new rub.Numbers()]));
      this.landmarks = [];
      this.sticks = new rub.Numbers();
      this.piece = new Piece();
      this.sample();
    }

    /** Return how much has been computed, in units of some microseconds. */
    get work() {
      return this.pieces + this.field.work;
    }

    get size() {
      return this.columns.time.length;
    }

    /** Return the place on the surface, in um. */
    get place() {
      return this.field.place(this.cell) + this.offset;
    }

    /** Return what the contact can bear where the slider is, and its slope, in uN and uN/um. */
    bearing() {
      const { field, cell } = this;
      const width = field.place(cell + 1) - field.place(cell);
      const slope = (field.force(cell + 1) - field.force(cell)) / width;
      return { width, slope, force: field.force(cell) + slope * this.offset };
    }

    /** Compute up to a time, or a distance, or the end; stop early where more work than that has been done. */
    until({ time = Infinity, distance = Infinity, work = Infinity }) {
      const most = this.work + work;
      while (!this.isOver && this.time < time && this.reached < distance && this.work < most) this.step();
      return this.isOver || this.time >= time || this.reached >= distance;
    }

    step() {
      if (this.phase === STICK) this.leave();
      else this.slip();
      this.pieces += 1;
      if (this.size > MOST_SAMPLES) this.isOver = true;
    }

    /** Stand still until the spring pulls as hard as the contact can bear, and break away: w = w' = 0, w'' = k V/m. */
    leave() {
      const { force } = this.bearing();
      const pull = this.stiffness * this.x + this.damping * this.drive;
      const duration = Math.max(0, force - pull) / (this.stiffness * this.drive);
      this.pass(duration, this.x + this.drive * duration, 0, 0);
      this.turn(SLIP, 1);
    }

    slip() {
      this.intoCell();
      const { width, slope, force } = this.bearing();
      const { mass, stiffness, damping, drive, way, u } = this;
      const net = way * (stiffness * this.x + damping * drive) - force;
      const push = (u > 0 ? net : Math.max(0, net)) / mass; // from w = 0 the way is forth, whatever is rounded
      const own = (stiffness + way * slope) / mass;
      this.piece.begin(damping / (2 * mass), own, u, push, (way * stiffness * drive) / mass);
      const left = way > 0 ? width - this.offset : this.offset;
      const [duration, ending] = this.piece.end(left);
      const passed = ending === 'cell' ? left : Math.min(this.piece.length(duration), left);
      const after = ending === 'rest' ? 0 : Math.max(0, this.piece.pace(duration));
      const before = this.piece.gain(0);
      this.offset = ending === 'cell' ? (way > 0 ? width : 0) : this.offset + way * passed;
      this.pass(duration, this.x + drive * duration - way * passed, after, -way * before, -way * this.piece.gain(duration));
      if (ending === 'rest') this.arrive();
    }

    /* A place on a node belongs to the cell that comes next on the way. */
    intoCell() {
      if (this.way < 0 && this.offset <= 0) {
        this.cell -= 1;
        this.offset = this.field.place(this.cell + 1) - this.field.place(this.cell);
      } else if (this.way > 0 && this.offset >= this.field.place(this.cell + 1) - this.field.place(this.cell)) {
        this.cell += 1;
        this.offset = 0;
      }
    }

    /** Decide at w = 0: stuck, or on in one of both ways. */
    arrive() {
      const { force } = this.bearing();
      const pull = this.stiffness * this.x + this.damping * this.drive;
      if (Math.abs(pull) <= force) this.turn(STICK, 1);
      else if (pull > 0) this.way > 0 || this.turn(SLIP, 1);
      else this.way < 0 || this.turn(REVERSAL, -1);
    }

    turn(phase, way) {
      const kind = phase === STICK ? 0 : phase === REVERSAL ? 2 : this.phase === STICK ? 1 : 3;
      this.phase = phase;
      this.way = way;
      this.u = 0;
      this.landmarks.push({ time: this.time, distance: this.place, kind, name: KINDS[kind], displacement: this.x });
      if (phase === STICK) this.sticks.push(this.time);
      this.sample();
    }

    /** Go on in time to another state, with the sums over the way there from values and slopes at both ends. */
    pass(duration, x, u, growth, growthAfter = growth) {
      const v = [this.drive - this.way * this.u, this.drive - this.way * u];
      const mean = (before, after, slope, slopeAfter) =>
        0.5 * duration * (before + after) + ((duration * duration) / 12) * (slope - slopeAfter);
      const { total } = this;
      total.sum += mean(this.x, x, v[0], v[1]);
      total.squares += mean(this.x ** 2, x ** 2, 2 * this.x * v[0], 2 * x * v[1]);
      total.velocitySquares += mean(v[0] ** 2, v[1] ** 2, 2 * v[0] * growth, 2 * v[1] * growthAfter);
      if (this.phase === STICK) total.stuck += duration;
      this.time += duration;
      this.x = x;
      this.u = u;
      this.reached = Math.max(this.reached, this.place);
      this.isOver = this.reached >= this.field.end - 1e-9;
      this.sample();
    }

    sample() {
      const { columns, sums, total } = this;
      const bears = this.bearing().force;
      const held = this.stiffness * this.x + this.damping * this.drive;
      columns.time.push(this.time);
      this.keep('displacement', this.x);
      this.keep('velocity', this.drive - this.way * this.u);
      this.keep('force', this.phase === STICK ? held : this.way * bears);
      columns.farthest.push(this.reached);
      columns.phase.push(this.phase);
      SUMS.forEach((name) => sums[name].push(total[name]));
    }

    keep(name, value) {
      const range = this.range[name];
      if (value < range[0]) range[0] = value;
      if (value > range[1]) range[1] = value;
      this.columns[name].push(value);
    }

    /** Return the stretches of time stuck, [from, to] in s, that lie between two times. */
    stuck(from, to) {
      const found = [];
      for (let i = this.landmarks.length - 1; i >= 0; i -= 1) {
        const { time, kind } = this.landmarks[i];
        const until = this.landmarks[i + 1]?.time ?? this.time;
        if (until < from) break;
        if (kind === 0 && time < to) found.push([Math.max(time, from), Math.min(until, to)]);
      }
      return found;
    }

    /** Return a column at a time that has been computed, by a straight line between samples. */
    at(name, time) {
      const { values } = this.columns[name] ?? this.sums[name];
      const times = this.columns.time.values;
      const i = Math.max(0, Math.min(this.columns.time.find(time), this.size - 2));
      const span = times[i + 1] - times[i];
      const part = span > 0 ? Math.min(1, (time - times[i]) / span) : 0;
      return values[i] + part * (values[i + 1] - values[i]);
    }

    /** Return the phase at a time: 0 slip, 1 stick, 2 reversal. */
    phaseAt(time) {
      return this.columns.phase.values[Math.max(0, this.columns.time.find(time))];
    }

    /** Return the place on the surface at a time, in um. */
    placeAt(time) {
      return this.drive * time - (this.at('displacement', time) - this.start);
    }

    /** Return when a distance that has been computed was reached first, in s. */
    timeAt(distance) {
      const { time, farthest } = this.columns;
      const i = Math.max(0, Math.min(farthest.find(distance), this.size - 2));
      if (farthest.values[i] >= distance) return time.values[i];
      const part = (distance - farthest.values[i]) / (farthest.values[i + 1] - farthest.values[i]);
      return time.values[i] + part * (time.values[i + 1] - time.values[i]);
    }

    /** Return means over time up to a time: displacement, its spread, the velocity's, share stuck, sticks per second. */
    moments(time) {
      const mean = (name) => (time > 0 ? this.at(name, time) / time : this.at(name, 0));
      const displacementMean = time > 0 ? mean('sum') : this.start;
      const square = time > 0 ? mean('squares') : this.start ** 2;
      return {
        displacementMean,
        displacementStd: Math.sqrt(Math.max(0, square - displacementMean ** 2)),
        velocityStd: Math.sqrt(Math.max(0, mean('velocitySquares'))),
        stuckShare: mean('stuck'),
        sticksPerSecond: time > 0 ? (this.sticks.find(time) + 1) / time : 0,
      };
    }
  }

  Object.assign(rub, { Motion, response });
})();
