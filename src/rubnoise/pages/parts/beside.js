/* Two runs side by side: a window that moves in one frame moves in the other. */
"use strict";
window.moved = (mover, from, to) => {
  for (const frame of document.querySelectorAll("iframe"))
    if (frame.contentWindow !== mover) frame.contentWindow.follow?.(from, to);
};
