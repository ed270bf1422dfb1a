/* One piece of slip, as long as the force on the way is a straight line: l'' + 2 a l' + b l = P + Q t, with l the
 * distance passed and u = l' the speed over the surface. It has a closed form, however stiff or damped, and where b < 0
 * as well. All that is searched for is when l reaches the end of the line, and whether u falls to 0 before.
 */
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
  const decay = Math.exp(-a * t);
  const [even, odd] = free(square, turn, t);
  into[0] = decay * odd;
  into[1] = decay * (even - a * odd);
  into[2] = (1 - into[1] - 2 * a * into[0]) / b;
  into[3] = (t - into[0] - 2 * a * into[2]) / b;
  return into;
}

/** Return cosh and sinh over the root of a square, or cos and sin where it is negative. */
function free(square, turn, t) {
  const angle = turn * t;
  if (angle < 1e-4) return [1 + (square * t * t) / 2, t * (1 + (square * t * t) / 6)];
  if (square < 0) return [Math.cos(angle), Math.sin(angle) / turn];
  return [Math.cosh(angle), Math.sinh(angle) / turn];
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
    if (pull > 0) {
      const alone = Math.cbrt((6 * distance) / pull) + Math.sqrt((4 * rate * distance) / pull);
      t = Math.min(t, alone * (start < 0 ? 3 : 1));
    }
    const square = own - rate * rate;
    if (square > 0) t = Math.min(t, 3 / Math.sqrt(square));
    if (own < 0) t = Math.min(t, (3 * (rate + Math.sqrt(-square))) / -own);
    return t < 1e9 ? 1.05 * t : 1;
  }

  /** Return how long the piece lasts and how it ends: at the distance ("cell"), at u = 0 ("rest"), or before both. */
  end(distance) {
    if (this.creeps()) return [this.crossing(distance, (1.05 * distance * this.own) / this.pull), 'cell'];
    const t = this.guess(distance);
    const rest = this.rest(t);
    const last = rest ?? t;
    if (this.length(last) < distance) return rest === null ? [t, 'on'] : [rest, 'rest'];
    return [this.crossing(distance, last), 'cell'];
  }

  /** Return when a distance is passed where u stays above 0; late: a time that is late enough, or nearly so. */
  crossing(distance, late) {
    let last = late;
    while (this.length(last) < distance) last *= 2;
    const ahead = (time) => this.length(time) - distance;
    return rootOf(ahead, this.pace, 0, last, distance / Math.max(this.speed, this.pace(last)));
  }

  /* Carried up a flank of the force: u swings about Q/b by less than that, and never comes to 0 again. */
  creeps() {
    const { speed, push, pull, rate, own } = this;
    const square = own - rate * rate;
    if (!(square > 0 && pull > 0)) return false;
    const drift = pull / own;
    const [even, odd] = [speed - drift, (push - rate * speed - rate * drift) / Math.sqrt(square)];
    return Math.hypot(even, odd) <= drift;
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

Object.assign(rub, { Piece, response });
