'use strict';
/* What all pictures share: a canvas as sharp as the screen, colours of the theme, axes, lines. */
(() => {
  const rub = (globalThis.rub ??= {});
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

  /** Fit a canvas to its place on the page; return a pen for it, with its width and height and those of its pixels. */
  function pen(canvas) {
    const state = { canvas, ctx: canvas.getContext('2d'), width: 0, height: 0, scale: 1, zoom: 1 };
    state.fit = () => {
      state.zoom = zoom;
      state.scale = zoom * Math.min(window.devicePixelRatio || 1, 2);
      state.width = canvas.clientWidth / zoom;
      state.height = canvas.clientHeight / zoom;
      canvas.width = Math.max(1, Math.round(state.width * state.scale));
      canvas.height = Math.max(1, Math.round(state.height * state.scale));
    };
    state.clear = () => {
      state.ctx.setTransform(state.scale, 0, 0, state.scale, 0, 0);
      state.ctx.clearRect(0, 0, state.width, state.height);
    };
    state.fit();
    return state;
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
    const size = Math.abs(value);
    if (size < DUST) return '0';
    const text = size !== 0 && (size >= 1e6 || size < 1e-4) ? value.toExponential(digits - 1) : plain(value, digits);
    return text.replace('-', '−');
  }

  function plain(value, digits) {
    const text = value.toPrecision(digits);
    const number = text.includes('e') ? String(Number(text)) : text;
    return number.includes('.') ? number.replace(/\.?0+$/, '') : number;
  }

  /** Draw a line through points of columns; x and y take an index. */
  function line(ctx, from, to, x, y) {
    ctx.beginPath();
    for (let i = from; i <= to; i += 1) {
      if (i === from) ctx.moveTo(x(i), y(i));
      else ctx.lineTo(x(i), y(i));
    }
    ctx.stroke();
  }

  /** Draw the frame of a picture: numbers on the left, and a title as by heading. box = {left, top, right, bottom}. */
  function leftAxis(ctx, box, low, high, title) {
    const y = (value) => box.bottom - ((value - low) / (high - low)) * (box.bottom - box.top);
    ctx.font = font(0.72);
    ctx.textAlign = 'right';
    ctx.textBaseline = 'middle';
    ctx.lineWidth = 1;
    for (const value of roundNumbers(low, high, Math.max(3, (box.bottom - box.top) / 40))) {
      ctx.strokeStyle = ink.faint;
      ctx.beginPath();
      ctx.moveTo(box.left, Math.round(y(value)) + 0.5);
      ctx.lineTo(box.right, Math.round(y(value)) + 0.5);
      ctx.stroke();
      ctx.fillStyle = ink.quiet;
      ctx.fillText(said(value), box.left - 5, y(value));
    }
    heading(ctx, box, title);
    return y;
  }

  /** Write the title of a picture into its upper left corner: of several ones the first that fits, or the last. */
  function heading(ctx, box, titles) {
    ctx.font = font(0.78);
    ctx.textAlign = 'left';
    ctx.textBaseline = 'bottom';
    ctx.fillStyle = ink.ink;
    ctx.fillText(fitting(ctx, titles, box.right - box.left), box.left, box.top - 4);
  }

  /** Return the first of some titles that fits into a width, or the last. */
  function fitting(ctx, titles, width) {
    const all = [titles].flat();
    return all.find((title) => !(ctx.measureText(title).width > width)) ?? all.at(-1);
  }

  /** Draw numbers below a picture, and what they count. */
  function lowerAxis(ctx, box, low, high, titles) {
    const x = (value) => box.left + ((value - low) / (high - low)) * (box.right - box.left);
    ctx.font = font(0.72);
    ctx.textAlign = 'center';
    ctx.textBaseline = 'top';
    ctx.fillStyle = ink.quiet;
    const title = fitting(ctx, titles, 0.6 * (box.right - box.left));
    const end = box.right - ctx.measureText(title).width - 16;
    for (const value of roundNumbers(low, high, Math.max(2, (box.right - box.left) / 90))) {
      if (x(value) > box.left - 1 && x(value) < end) ctx.fillText(said(value), x(value), box.bottom + 3);
    }
    ctx.textAlign = 'right';
    ctx.fillText(title, box.right, box.bottom + 3);
    return x;
  }

  rub.plot = { ink, readTheme, colourOf, pen, roundNumbers, said, line, leftAxis, lowerAxis, heading };
})();
