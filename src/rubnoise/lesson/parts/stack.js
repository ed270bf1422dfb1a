'use strict';
/* The areas of single junctions, layer upon layer, kept as a picture that grows by columns while the run slides on. */
(() => {
  const rub = (globalThis.rub ??= {});
  const { ink, colourOf } = rub.plot;
  const MOST_RECTANGLES = 40000; // at one jump
  const canvas = document.createElement('canvas');
  const ctx = canvas.getContext('2d');
  const live = [];
  const stack = { from: 0, to: -1, width: 0, height: 0, top: 1, spacing: 1 };

  /** Begin anew where anything is other: pixels wide and high, top the area at the upper edge, spacing um in a pixel. */
  stack.begin = (width, height, top, spacing) => {
    const wanted = { width, height, top, spacing };
    if (Object.entries(wanted).every(([name, value]) => stack[name] === value)) return;
    Object.assign(stack, wanted, { from: 0, to: -1 });
    Object.assign(canvas, { width, height });
  };

  /** Forget what is drawn. */
  stack.forget = () => {
    stack.to = -1;
    stack.from = 0;
  };

  /** Make sure that columns from one up to another are there; columns are numbered by distance over spacing. */
  stack.until = (from, to) => {
    if (to < stack.to || from > stack.to + 1 || from < stack.from) stack.forget();
    const begin = stack.to < 0 ? from : stack.to + 1;
    if (stack.to < 0) stack.from = from;
    const stride = Math.max(1, Math.ceil(((to - begin + 1) * Math.max(1, rub.run.living.length)) / MOST_RECTANGLES));
    /* The picture is a ring: what is as wide as several columns ends at its edge at the latest. */
    for (let column = begin, count = 1; column <= to; column += count) {
      count = Math.min(stride, to - column + 1, stack.width - (column % stack.width));
      draw(column, count);
    }
    stack.to = to;
    stack.from = Math.max(stack.from, to - stack.width + 1);
  };

  function draw(column, count) {
    const distance = (column + 0.5) * stack.spacing;
    const { area } = rub.run.trace.pulse;
    const largest = rub.stage.largest();
    let y = stack.height;
    ctx.clearRect(column % stack.width, 0, count, stack.height);
    for (const row of rub.run.liveAt(distance, live)) {
      const value = area(distance - row.birth, row.diameter, row.offset);
      const height = (value / stack.top) * stack.height;
      ctx.globalAlpha = row.id % 2 ? 0.62 : 0.88;
      ctx.fillStyle = colourOf(value / largest);
      if (row.id === rub.run.selected) {
        ctx.globalAlpha = 1;
        ctx.fillStyle = ink.accent;
      }
      ctx.fillRect(column % stack.width, y - height, count, height);
      y -= height;
    }
  }

  /** Paint the columns from one up to another, the first at x, each so many pixels of the page wide. */
  stack.paint = (target, from, to, x, y, pixel) => {
    for (let column = from; column <= to;) {
      const start = column % stack.width;
      const count = Math.min(to - column + 1, stack.width - start);
      const place = [x + (column - from) * pixel, y, count * pixel, stack.height * pixel];
      target.drawImage(canvas, start, 0, count, stack.height, ...place);
      column += count;
    }
  };

  rub.stack = stack;
})();
