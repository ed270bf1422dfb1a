/* A slider that pushes back: m x'' + c x' + k x = G(s) sign(w), w = V - x', s = V t - (x - x_0). At w = 0, with
 * f = k x + c V: |f| <= G sticks, f > G goes forward, f < -G goes back. Static and kinetic friction are the same.
 *
 * From node to node of the field G is a straight line, and there the motion is a closed form (piece.js). So nothing
 * depends on frames. What errs is the broken line: over one slip x is right to 1e-4 of itself.
 */
const SLIP = 0;
const STICK = 1;
const REVERSAL = 2;
const KINDS = ['stick', 'slip', 'reversal', 'forward'];
const COLUMNS = ['time', 'displacement', 'velocity', 'force', 'farthest', 'phase'];
const SUMS = ['sum', 'squares', 'velocitySquares', 'stuck']; // over time, of x, x^2, x'^2 and being stuck
const MOST_SAMPLES = 1500000; // some 100 MB

/** The motion of a slider over a field, as far as computed: a sample wherever it meets a node or turns. */
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
    this.piece = new rub.Piece();
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
    const gains = [before, this.piece.gain(duration)].map((gain) => -way * gain);
    this.pass(duration, this.x + drive * duration - way * passed, after, ...gains);
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
    return rub.between(values, this.columns.time.placeOf(time));
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
    return rub.between(time.values, farthest.placeOf(distance));
  }

  /** Return means over time up to a time: of x, its spread and that of x', share stuck, sticks per second. */
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

rub.Motion = Motion;
