/* What all pictures share: a canvas as sharp as the screen, colours of the theme, axes, lines, and fingers on them. */
const INKS = ['ink', 'quiet', 'faint', 'ground', 'accent', 'exact', 'band', 'birth', 'death', 'second', 'stuck'];
/* Dark blue, teal, green, yellow: rising in lightness, so that it reads without hue too. */
const RAMPS = {
  light: [
    [40, 30, 110],
    [38, 92, 146],
    [32, 146, 140],
    [110, 190, 90],
    [244, 210, 40],
  ],
  dark: [
    [86, 84, 190],
    [60, 130, 190],
    [50, 170, 160],
    [140, 205, 100],
    [250, 225, 70],
  ],
};
const SHADES = 64;
const LEFT = 46; // pixels for the numbers of an axis
const DUST = 1e-12; // what rounding leaves where a law says nothing
const ink = {};
let shades = [];
let rem = 16; // pixels: text in pictures grows with the text around them
let zoom = 1; // pixels of the page in a pixel of a picture: everything in it grows, lines too

/** Read the colours of the theme from the style sheet. */
function readTheme() {
  const style = getComputedStyle(document.documentElement);
  zoom = parseFloat(style.getPropertyValue('--zoom')) || 1;
  rem = (parseFloat(style.fontSize) || 16) / zoom;
  for (const name of INKS) ink[name] = style.getPropertyValue(`--${name}`).trim();
  const ramp = RAMPS[style.getPropertyValue('--ramp').trim()] ?? RAMPS.light;
  shades = Array.from({ length: SHADES }, (_, i) => shade(ramp, i / (SHADES - 1)));
}

function shade(ramp, part) {
  const at = Math.min(part * (ramp.length - 1), ramp.length - 1.0001);
  const [low, high] = [ramp[Math.floor(at)], ramp[Math.floor(at) + 1]];
  const mixed = low.map((value, i) => Math.round(value + (high[i] - value) * (at % 1)));
  return `rgb(${mixed.join(',')})`;
}

const font = (size) => `${(size * rem).toFixed(1)}px system-ui, sans-serif`;

/** Return the colour of a part of the largest area, 0 to 1. */
function colourOf(part) {
  return shades[Math.max(0, Math.min(SHADES - 1, Math.floor(part * SHADES)))];
}

/** Return round numbers from low to high, about so many. */
function roundNumbers(low, high, about) {
  const rough = (high - low) / about;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= 0.7 * rough);
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1) found.push(i * step);
  return found;
}

/** Return a number as the page prints it: so many digits that count, no trailing zeros, a true minus. */
function said(value, digits = 4) {
  if (!Number.isFinite(value)) return '–';
  const short = Math.abs(value) < DUST ? 0 : Number(value.toPrecision(digits));
  const size = Math.abs(short);
  return (size !== 0 && (size >= 1e6 || size < 1e-4) ? short.toExponential() : String(short)).replace('-', '−');
}

/** Return the first of some titles that fits into a width, or the last. */
function fitting(ctx, titles, width) {
  const all = [titles].flat();
  return all.find((title) => !(ctx.measureText(title).width > width)) ?? all.at(-1);
}

const pictures = [];

/**
 * A picture on a canvas. Places are pixels of the page; x and y take values of the axes to them. A style has a colour, a
 * width and dashes.
 */
class Picture {
  constructor(canvas, draw) {
    Object.assign(this, { canvas, draw, ctx: canvas.getContext('2d'), width: 0, height: 0, scale: 1, zoom: 1 });
    this.fit();
  }

  /** Fit the canvas to its place on the page, as sharp as the screen. */
  fit() {
    const { canvas } = this;
    this.zoom = zoom;
    this.scale = zoom * Math.min(window.devicePixelRatio || 1, 2);
    this.width = canvas.clientWidth / zoom;
    this.height = canvas.clientHeight / zoom;
    canvas.width = Math.max(1, Math.round(this.width * this.scale));
    canvas.height = Math.max(1, Math.round(this.height * this.scale));
  }

  /** Draw anew, if the picture is in sight. */
  redraw(seen) {
    if (!this.width) return;
    this.ctx.setTransform(this.scale, 0, 0, this.scale, 0, 0);
    this.ctx.clearRect(0, 0, this.width, this.height);
    this.draw(this, seen);
  }

  /** Leave so many pixels around what is drawn. */
  frame(left = LEFT, right = 8, top = 18, bottom = 18) {
    this.box = { left, top, right: this.width - right, bottom: this.height - bottom };
    return this.box;
  }

  /** Draw numbers on the left, and a title as by heading. */
  up(low, high, title) {
    const { ctx, box } = this;
    this.y = (value) => box.bottom - ((value - low) / (high - low)) * (box.bottom - box.top);
    ctx.font = font(0.72);
    for (const value of roundNumbers(low, high, Math.max(3, (box.bottom - box.top) / 40))) {
      this.level(Math.round(this.y(value)) + 0.5, { colour: ink.faint, width: 1 });
      this.text(said(value), box.left - 5, this.y(value), 'right', 'middle', ink.quiet);
    }
    this.heading(title);
  }

  /** Draw numbers below, and what they count. */
  across(low, high, titles, box = this.box) {
    const { ctx } = this;
    this.x = (value) => box.left + ((value - low) / (high - low)) * (box.right - box.left);
    ctx.font = font(0.72);
    const title = fitting(ctx, titles, 0.6 * (box.right - box.left));
    const end = box.right - ctx.measureText(title).width - 16;
    for (const value of roundNumbers(low, high, Math.max(2, (box.right - box.left) / 90))) {
      const x = this.x(value);
      if (x > box.left - 1 && x < end) this.text(said(value), x, box.bottom + 3, 'center', 'top', ink.quiet);
    }
    this.text(title, box.right, box.bottom + 3, 'right', 'top', ink.quiet);
  }

  /** Draw both axes. */
  axes([low, high, title], [from, to, titles]) {
    this.up(low, high, title);
    this.across(from, to, titles);
  }

  /** Write the title into the upper left corner: of several ones the first that fits, or the last. */
  heading(titles, { left, right, top } = this.box) {
    this.ctx.font = font(0.78);
    this.text(fitting(this.ctx, titles, right - left), left, top - 4);
  }

  text(text, x, y, align = 'left', baseline = 'bottom', colour = ink.ink) {
    Object.assign(this.ctx, { textAlign: align, textBaseline: baseline, fillStyle: colour });
    this.ctx.fillText(text, x, y);
  }

  /** Stroke what a function outlines. */
  stroke(outline, { colour = ink.ink, width = 1.5, dash = [] } = {}) {
    const { ctx } = this;
    Object.assign(ctx, { strokeStyle: colour, lineWidth: width, lineJoin: 'round' });
    ctx.setLineDash(dash);
    ctx.beginPath();
    outline(ctx);
    ctx.stroke();
    ctx.setLineDash([]);
  }

  /** Fill what a function outlines. */
  fill(outline, colour) {
    this.ctx.fillStyle = colour;
    this.ctx.beginPath();
    outline(this.ctx);
    this.ctx.fill();
  }

  /** Draw ground from an edge of the picture up to a surface; y takes pixels across, a step apart. */
  ground(edge, y, colour, step = 1) {
    const outline = (ctx) => {
      ctx.moveTo(0, edge);
      for (let x = 0; x <= this.width + step; x += step) ctx.lineTo(x, y(x));
      ctx.lineTo(this.width, edge);
      ctx.closePath();
    };
    this.fill(outline, ink.faint);
    this.stroke(outline, { colour, width: 1.2 });
  }

  /** Draw a line through points; x and y take an index. */
  curve(from, to, x, y, style) {
    this.stroke((ctx) => {
      for (let i = from; i <= to; i += 1) ctx.lineTo(x(i), y(i));
    }, style);
  }

  /** Draw lines, each through some places [x, y]. */
  lines(lines, style) {
    this.stroke((ctx) => {
      for (const line of lines) line.forEach(([x, y], i) => (i ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
    }, style);
  }

  level(y, style, { left, right } = this.box) {
    this.lines([[[left, y], [right, y]]], style);
  }

  upright(x, style, { top, bottom } = this.box) {
    this.lines([[[x, top], [x, bottom]]], style);
  }

  /** Fill the frame from one place to another. */
  shade(left, right, colour, { top, bottom } = this.box) {
    this.ctx.fillStyle = colour;
    this.ctx.fillRect(left, top, right - left, bottom - top);
  }

  dot(x, y, colour, radius = 4) {
    this.fill((ctx) => ctx.arc(x, y, radius, 0, 2 * Math.PI), colour);
  }

  circle(x, y, radius, style) {
    this.stroke((ctx) => ctx.arc(x, y, radius, 0, 2 * Math.PI), style);
  }

  /** Draw within the frame what may leave it. */
  clipped(draw, { left, top, right, bottom } = this.box) {
    const { ctx } = this;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, right - left, bottom - top);
    ctx.clip();
    draw();
    ctx.restore();
  }
}

/** Make a picture that is drawn in every frame; a slow one some times a second; fitted is called after it is fitted. */
function picture(id, draw, { slow = false, fitted = () => {} } = {}) {
  const made = Object.assign(new Picture(document.getElementById(id), draw), { slow, fitted });
  pictures.push(made);
  return made;
}

/* Dashes of what has been seen so far, beside what is exact. */
const DASHED = { dash: [5, 4] };

rub.plot = { ink, readTheme, colourOf, said, Picture, picture, pictures, DASHED };
