/* The phase plane: velocity over displacement of the window, or the time that the whole run spends in each cell. */
"use strict";
(() => {
  const MOST = 20000;
  const figure = document.getElementById("phase");

  /** Each cell of the plane, the darker the more ticks are in it, in logarithms. */
  const cells = (ctx, { across: count, place, velocity, counts }, across, up) => {
    const ticks = view.unpacked(counts);
    const most = Math.log1p(ticks.reduce((a, b) => Math.max(a, b), 1));
    const at = ([low, high], part) => low + (high - low) * part;
    ticks.forEach((tick, cell) => {
      const [x, v] = [cell % count, Math.floor(cell / count)];
      const [left, right] = [x, x + 1].map((one) => across(at(place, one / count)));
      const [bottom, top] = [v, v + 1].map((one) => up(at(velocity, (one * count) / ticks.length)));
      ctx.globalAlpha = Math.log1p(tick) / most;
      ctx.fillRect(left, top, right - left, bottom - top);
    });
    ctx.globalAlpha = 1;
  };

  view.drawPhase = () => {
    const slider = view.groups.slider;
    const whole = view.isWhole() ? view.data.whole.phase : null;
    figure.hidden = !slider || (!whole && !view.showsRows());
    if (figure.hidden) return;
    const canvas = figure.querySelector("canvas");
    const size = Math.min(figure.clientWidth, 420);
    const scale = devicePixelRatio;
    canvas.style.width = `${size}px`;
    canvas.style.height = `${0.8 * size}px`;
    [canvas.width, canvas.height] = [size * scale, 0.8 * size * scale];
    const ctx = canvas.getContext("2d");
    ctx.scale(scale, scale);
    const frame = { left: 64, top: 12, width: size - 78, height: 0.8 * size - 60 };
    const timed = "phase" in slider.units;
    const { from, to } = view.window;
    const inside = (row) => Math.min(Math.max(row - slider.first, 0), slider.displacement.length);
    const pace = timed ? slider.time[1] - slider.time[0] : view.data.tick;
    const [first, last] = [view.timeAt(from), view.timeAt(to)].map((x, i) => inside(Math[i ? "ceil" : "floor"](x / pace) + i));
    const step = Math.max(1, Math.ceil((last - first) / MOST));
    let [x0, x1, v0, v1] = [Infinity, -Infinity, 0, timed ? view.data.speed : 0];
    if (whole) [x0, x1, v0, v1] = [...whole.place, Math.min(v0, whole.velocity[0]), Math.max(v1, whole.velocity[1])];
    else for (let i = first; i < last; i += 1) {
      [x0, x1] = [Math.min(x0, slider.displacement[i]), Math.max(x1, slider.displacement[i])];
      [v0, v1] = [Math.min(v0, slider.velocity[i]), Math.max(v1, slider.velocity[i])];
    }
    const across = (x) => frame.left + (frame.width * (x - x0)) / (x1 - x0 || 1);
    const up = (v) => frame.top + frame.height * (1 - (v - v0) / (v1 - v0 || 1));
    ctx.strokeStyle = view.ink("grid");
    ctx.strokeRect(frame.left, frame.top, frame.width, frame.height);
    for (const v of [0, ...(timed ? [view.data.speed] : [])]) {
      ctx.setLineDash(v ? [5, 4] : []);
      ctx.beginPath();
      ctx.moveTo(frame.left, up(v));
      ctx.lineTo(frame.left + frame.width, up(v));
      ctx.stroke();
    }
    ctx.setLineDash([]);
    ctx.strokeStyle = ctx.fillStyle = view.ink("curve");
    if (whole) cells(ctx, whole, across, up);
    else {
      ctx.beginPath();
      for (let i = first; i < last; i += step) ctx.lineTo(across(slider.displacement[i]), up(slider.velocity[i]));
      ctx.stroke();
    }
    ctx.fillStyle = view.ink("ink");
    ctx.font = "12px system-ui";
    const short = (value) => String(Number(value.toPrecision(3)));
    ctx.textAlign = "right";
    ctx.fillText(short(v1), frame.left - 6, frame.top + 10);
    ctx.fillText(short(v0), frame.left - 6, frame.top + frame.height);
    ctx.textAlign = "left";
    if (timed) ctx.fillText("V", frame.left + frame.width + 3, up(view.data.speed) + 4);
    ctx.fillText(short(x0), frame.left, frame.top + frame.height + 16);
    ctx.textAlign = "right";
    ctx.fillText(short(x1), frame.left + frame.width, frame.top + frame.height + 16);
    ctx.textAlign = "center";
    ctx.fillText("displacement x (µm)", frame.left + frame.width / 2, frame.top + frame.height + 34);
    ctx.save();
    ctx.translate(14, frame.top + frame.height / 2);
    ctx.rotate(-Math.PI / 2);
    ctx.fillText("velocity x′ (µm/s)", 0, 0);
    ctx.restore();
  };
})();
