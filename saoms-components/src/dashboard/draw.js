// The map: blocks, zones, grants, luggage and robots on a canvas, which is fast enough for thousands of robots.

import { same } from "./state.js";

/** Time in which a robot glides to its next block. */
const GLIDE_MS = 260;
const [SMALLEST, LARGEST] = [3, 90];

const NAMES = ["ground", "surface", "raised", "text", "muted", "border", "accent", "danger", "good", "warn"];

/** The colour of a robot by its state. */
function colour(robot, theme) {
  if (robot.isBroken || robot.isStopped) return theme.danger;
  switch (robot.state) {
    case "carries luggage": return theme.good;
    case "goes to luggage": return theme.accent;
    case "goes to charge": case "charges": return theme.warn;
    case "asleep": case "off": return theme.border;
    default: return theme.muted;
  }
}

export class FloorMap {
  constructor(floor, { choose, pick }) {
    Object.assign(this, { floor, choose, pick });
    this.canvas = document.createElement("canvas");
    this.canvas.className = "floor-map";
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "application");
    this.selected = null;
    this.marked = [];
    this.layers = { grants: true, chargers: true };
    this.cell = 0;
    this.offset = { x: 0, y: 0 };
    this.isFitted = true;
    this.frame = null;
    this.pointers = new Map();
    this.sizes = new ResizeObserver(() => this.#resize());
    this.sizes.observe(this.canvas);
    this.scheme = matchMedia("(prefers-color-scheme: dark)");
    this.themed = () => ((this.theme = null), this.redraw());
    this.scheme.addEventListener("change", this.themed);
    for (const name of ["pointerdown", "pointermove", "pointerup", "pointercancel"]) this.canvas.addEventListener(name, (event) => this.#pointer(event));
    this.canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY / 400), event.offsetX, event.offsetY);
    }, { passive: false });
    this.canvas.addEventListener("keydown", (event) => this.#key(event));
  }

  close() {
    this.sizes.disconnect();
    this.scheme.removeEventListener("change", this.themed);
    cancelAnimationFrame(this.frame);
  }

  redraw() {
    this.frame ??= requestAnimationFrame((now) => this.#draw(now));
  }

  fit() {
    const { area } = this.floor;
    if (!area || !this.width) return;
    const room = 22;
    this.cell = Math.min(LARGEST, Math.max(SMALLEST, Math.min((this.width - room - 6) / area.width, (this.height - room - 6) / area.height)));
    this.offset = { x: (this.width + room - 6 - area.width * this.cell) / 2, y: (this.height + room - 6 - area.height * this.cell) / 2 };
    this.isFitted = true;
    this.redraw();
  }

  zoom(factor, x = this.width / 2, y = this.height / 2) {
    const cell = Math.min(LARGEST, Math.max(SMALLEST, this.cell * factor));
    const ratio = cell / this.cell;
    this.offset = { x: x - (x - this.offset.x) * ratio, y: y - (y - this.offset.y) * ratio };
    this.cell = cell;
    this.isFitted = false;
    this.redraw();
  }

  #move(dx, dy) {
    this.offset.x += dx;
    this.offset.y += dy;
    this.isFitted = false;
    this.redraw();
  }

  #resize() {
    const scale = window.devicePixelRatio || 1;
    [this.width, this.height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    [this.canvas.width, this.canvas.height] = [Math.round(this.width * scale), Math.round(this.height * scale)];
    this.scale = scale;
    if (this.isFitted) this.fit();
    this.redraw();
  }

  #pointer(event) {
    const { pointers } = this;
    const last = pointers.get(event.pointerId);
    if (event.type === "pointerdown") {
      this.canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, { x: event.offsetX, y: event.offsetY, way: 0 });
      return;
    }
    if (!last) return;
    if (event.type !== "pointermove") {
      pointers.delete(event.pointerId);
      if (event.type === "pointerup" && last.way < 6 && pointers.size === 0) this.#click(event.offsetX, event.offsetY);
      return;
    }
    const [dx, dy] = [event.offsetX - last.x, event.offsetY - last.y];
    last.way += Math.abs(dx) + Math.abs(dy);
    const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      const distance = (one) => Math.hypot(one.x - other.x, one.y - other.y) || 1;
      const before = distance(last);
      [last.x, last.y] = [event.offsetX, event.offsetY];
      this.zoom(distance(last) / before, (last.x + other.x) / 2, (last.y + other.y) / 2);
      return;
    }
    [last.x, last.y] = [event.offsetX, event.offsetY];
    if (last.way > 6) this.#move(dx, dy);
  }

  #click(x, y) {
    const [column, row] = [(x - this.offset.x) / this.cell, (y - this.offset.y) / this.cell];
    const block = { x: Math.floor(column), y: Math.floor(row) };
    const { area } = this.floor;
    const isInside = block.x >= 0 && block.y >= 0 && block.x < area.width && block.y < area.height;
    if (isInside && this.pick(block)) return;
    const near = [...this.floor.robots.values()].map((robot) => [Math.hypot(robot.drawn.x + 0.5 - column, robot.drawn.y + 0.5 - row), robot]).sort(([a], [b]) => a - b)[0];
    this.choose(near && near[0] < Math.max(0.6, 14 / this.cell) ? near[1].path : null);
  }

  #key(event) {
    const step = 60;
    const keys = {
      ArrowLeft: () => this.#move(step, 0), ArrowRight: () => this.#move(-step, 0),
      ArrowUp: () => this.#move(0, step), ArrowDown: () => this.#move(0, -step),
      "+": () => this.zoom(1.25), "=": () => this.zoom(1.25), "-": () => this.zoom(0.8), 0: () => this.fit(),
      n: () => this.#next(1), p: () => this.#next(-1), Escape: () => this.choose(null),
    };
    const act = event.ctrlKey || event.metaKey || event.altKey ? null : keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }

  #next(by) {
    const paths = [...this.floor.robots.values()].sort((a, b) => a.number - b.number).map((robot) => robot.path);
    if (paths.length === 0) return;
    const now = paths.indexOf(this.selected);
    this.choose(paths[now < 0 ? 0 : (now + by + paths.length) % paths.length]);
  }

  /** Moves the map so that a robot can be seen. */
  reveal(path) {
    const robot = this.floor.robots.get(path);
    if (!robot) return;
    const [x, y] = [this.offset.x + (robot.drawn.x + 0.5) * this.cell, this.offset.y + (robot.drawn.y + 0.5) * this.cell];
    if (x < 0 || y < 0 || x > this.width || y > this.height) this.#move(this.width / 2 - x, this.height / 2 - y);
  }

  #draw(now) {
    this.frame = null;
    const { floor, cell, offset } = this;
    if (!floor.area || !this.width) return;
    if (this.fitted !== floor.area.width + floor.area.height && this.isFitted) {
      this.fitted = floor.area.width + floor.area.height;
      return this.fit();
    }
    if (!this.theme) {
      const style = getComputedStyle(this.canvas);
      this.theme = Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
    }
    const passed = Math.min(1000, now - (this.drawnAt ?? now - 16));
    this.drawnAt = now;
    const pen = this.canvas.getContext("2d");
    pen.setTransform(this.scale, 0, 0, this.scale, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    this.#ground(pen);
    pen.translate(offset.x, offset.y);
    if (this.layers.grants) this.#grants(pen);
    this.#zones(pen);
    if (this.layers.chargers) this.#chargers(pen);
    this.#luggage(pen);
    for (const block of this.marked) this.#mark(pen, block);
    let isMoving = false;
    for (const robot of floor.robots.values()) isMoving = this.#glide(robot, passed) || isMoving;
    this.#conflicts(pen);
    const seen = (robot) => {
      const [x, y] = [offset.x + robot.drawn.x * cell, offset.y + robot.drawn.y * cell];
      return x > -cell && y > -cell && x < this.width && y < this.height;
    };
    for (const robot of floor.robots.values()) if (seen(robot)) this.#robot(pen, robot);
    if (isMoving) this.redraw();
  }

  /** Brings a robot closer to its block; `true` while it is not there. */
  #glide(robot, passed) {
    const { drawn, block } = robot;
    const [dx, dy] = [block.x - drawn.x, block.y - drawn.y];
    const way = Math.hypot(dx, dy);
    const step = passed / GLIDE_MS;
    // Who was set elsewhere does not fly there.
    if (way <= step || way > 3) {
      [drawn.x, drawn.y] = [block.x, block.y];
      return false;
    }
    drawn.x += (dx / way) * Math.max(step, way * step);
    drawn.y += (dy / way) * Math.max(step, way * step);
    return true;
  }

  #ground(pen) {
    const { floor: { area }, cell, offset, theme } = this;
    const [width, height] = [area.width * cell, area.height * cell];
    pen.fillStyle = theme.surface;
    pen.fillRect(offset.x, offset.y, width, height);
    if (cell >= 7) {
      pen.beginPath();
      for (let x = 1; x < area.width; x++) pen.rect(Math.round(offset.x + x * cell), offset.y, 0, height);
      for (let y = 1; y < area.height; y++) pen.rect(offset.x, Math.round(offset.y + y * cell), width, 0);
      pen.strokeStyle = theme.border;
      pen.globalAlpha = 0.55;
      pen.lineWidth = 1;
      pen.stroke();
      pen.globalAlpha = 1;
    }
    pen.fillStyle = theme.border;
    for (const { x, y } of area.blocked) pen.fillRect(offset.x + x * cell, offset.y + y * cell, cell, cell);
    pen.strokeStyle = theme.border;
    pen.strokeRect(offset.x, offset.y, width, height);
    // Columns and rows, as many as have room.
    pen.fillStyle = theme.muted;
    pen.font = "10.5px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    const every = [1, 2, 5, 10, 20, 50, 100].find((one) => one * cell >= 24) ?? 200;
    for (let x = 0; x < area.width; x += every) pen.fillText(x, offset.x + (x + 0.5) * cell, Math.max(8, offset.y - 9));
    for (let y = 0; y < area.height; y += every) pen.fillText(y, Math.max(9, offset.x - 11), offset.y + (y + 0.5) * cell);
  }

  #zones(pen) {
    const { cell, theme } = this;
    if (this.floor.zones.length < 2) return;
    pen.strokeStyle = theme.accent;
    pen.fillStyle = theme.accent;
    pen.lineWidth = 1.5;
    pen.setLineDash([6, 4]);
    pen.textAlign = "left";
    pen.textBaseline = "top";
    for (const { corner, width, height, zone } of this.floor.zones) {
      pen.globalAlpha = 0.75;
      pen.strokeRect(corner.x * cell + 1.5, corner.y * cell + 1.5, width * cell - 3, height * cell - 3);
      pen.fillText(`zone ${zone}`, corner.x * cell + 6, corner.y * cell + 5);
    }
    pen.setLineDash([]);
    pen.globalAlpha = 1;
  }

  #grants(pen) {
    const { cell, theme, floor } = this;
    pen.fillStyle = theme.accent;
    for (const [number, steps] of floor.grants) {
      const robot = floor.byNumber.get(number);
      if (!robot) continue;
      pen.globalAlpha = robot.path === this.selected ? 0.32 : 0.13;
      for (const { x, y } of steps) pen.fillRect(x * cell + 0.5, y * cell + 0.5, cell - 1, cell - 1);
    }
    pen.globalAlpha = 1;
  }

  #chargers(pen) {
    const { cell, theme } = this;
    if (cell < 9) return;
    pen.strokeStyle = theme.warn;
    pen.lineWidth = 1.2;
    pen.globalAlpha = 0.65;
    for (const { charger } of this.floor.robots.values()) {
      if (!charger) continue;
      const [x, y, r] = [(charger.x + 0.5) * cell, (charger.y + 0.5) * cell, cell * 0.44];
      pen.strokeRect(x - r, y - r, 2 * r, 2 * r);
    }
    pen.globalAlpha = 1;
  }

  #luggage(pen) {
    const { cell, theme } = this;
    const size = Math.max(3, cell * 0.3);
    for (const piece of this.floor.luggage) {
      const isChosen = piece.robot !== null && piece.robot.path === this.selected;
      const from = piece.isCarried ? piece.robot.drawn : piece.from;
      if (isChosen) {
        pen.strokeStyle = theme.good;
        pen.lineWidth = 1.5;
        pen.setLineDash([4, 4]);
        pen.beginPath();
        pen.moveTo((from.x + 0.5) * cell, (from.y + 0.5) * cell);
        pen.lineTo((piece.to.x + 0.5) * cell, (piece.to.y + 0.5) * cell);
        pen.stroke();
        pen.setLineDash([]);
        pen.strokeRect(piece.to.x * cell + 2, piece.to.y * cell + 2, cell - 4, cell - 4);
      }
      if (piece.isCarried) continue;
      const [x, y] = [(piece.from.x + 0.5) * cell, (piece.from.y + 0.5) * cell];
      pen.fillStyle = piece.robot ? theme.accent : theme.warn;
      pen.strokeStyle = theme.surface;
      pen.lineWidth = 1;
      pen.beginPath();
      pen.roundRect(x - size / 2, y - size / 2.6, size, size * 0.77, size * 0.16);
      pen.fill();
      pen.stroke();
      if (size > 7) {
        pen.strokeStyle = pen.fillStyle;
        pen.lineWidth = Math.max(1, size * 0.1);
        pen.beginPath();
        pen.arc(x, y - size / 2.6, size * 0.2, Math.PI, 0);
        pen.stroke();
      }
    }
  }

  #mark(pen, block) {
    if (!block) return;
    const { cell, theme } = this;
    pen.strokeStyle = theme.accent;
    pen.lineWidth = 2;
    pen.strokeRect(block.x * cell + 1, block.y * cell + 1, cell - 2, cell - 2);
  }

  #conflicts(pen) {
    const { cell, theme, floor } = this;
    pen.strokeStyle = theme.danger;
    pen.lineWidth = 1.6;
    pen.setLineDash([3, 3]);
    pen.beginPath();
    for (const conflict of floor.conflicts.values()) {
      const [from, to] = [floor.robots.get(conflict.robot), floor.robots.get(conflict.other)];
      if (!from || !to) continue;
      pen.moveTo((from.drawn.x + 0.5) * cell, (from.drawn.y + 0.5) * cell);
      pen.lineTo((to.drawn.x + 0.5) * cell, (to.drawn.y + 0.5) * cell);
    }
    pen.stroke();
    pen.setLineDash([]);
  }

  #robot(pen, robot) {
    const { cell, theme } = this;
    const [x, y] = [(robot.drawn.x + 0.5) * cell, (robot.drawn.y + 0.5) * cell];
    const radius = Math.max(2.6, cell * 0.4);
    const fill = colour(robot, theme);
    pen.globalAlpha = robot.isOff || robot.isStale ? 0.5 : 1;
    if (cell < 11) {
      pen.fillStyle = fill === theme.border ? theme.muted : fill;
      pen.beginPath();
      pen.arc(x, y, radius, 0, 7);
      pen.fill();
      if (robot.path === this.selected) this.#ring(pen, x, y, radius + 4);
      pen.globalAlpha = 1;
      return;
    }
    // Where it goes next.
    const goal = same(robot.next, robot.block) ? robot.wanted : robot.next;
    if (!same(goal, robot.block)) {
      pen.strokeStyle = fill;
      pen.lineWidth = 2;
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo((goal.x + 0.5) * cell, (goal.y + 0.5) * cell);
      pen.stroke();
    }
    const ring = Math.max(2, cell * 0.075);
    pen.fillStyle = theme.surface;
    pen.beginPath();
    pen.arc(x, y, radius, 0, 7);
    pen.fill();
    pen.fillStyle = fill;
    pen.beginPath();
    pen.arc(x, y, radius - ring * 1.9, 0, 7);
    pen.fill();
    const level = Math.max(0, Math.min(100, robot.battery ?? 0)) / 100;
    pen.lineWidth = ring;
    pen.strokeStyle = theme.border;
    pen.beginPath();
    pen.arc(x, y, radius - ring / 2, 0, 7);
    pen.stroke();
    pen.strokeStyle = level > 0.4 ? theme.good : level > 0.2 ? theme.warn : theme.danger;
    pen.beginPath();
    pen.arc(x, y, radius - ring / 2, -Math.PI / 2, -Math.PI / 2 + level * 2 * Math.PI);
    pen.stroke();
    if (cell >= 17) {
      pen.fillStyle = fill === theme.border ? theme.text : theme.surface;
      pen.font = `600 ${Math.round(cell * (robot.number > 99 ? 0.25 : 0.31))}px system-ui, sans-serif`;
      pen.textAlign = "center";
      pen.textBaseline = "middle";
      pen.fillText(robot.number, x, y + 0.5);
    }
    if (robot.isBroken) {
      // A cross, beside the number.
      const [left, top, half] = [x + radius * 0.75, y - radius * 0.75, cell * 0.13];
      pen.fillStyle = theme.danger;
      pen.beginPath();
      pen.arc(left, top, half * 1.5, 0, 7);
      pen.fill();
      pen.strokeStyle = theme.surface;
      pen.lineWidth = Math.max(1.5, cell * 0.035);
      pen.beginPath();
      for (const side of [1, -1]) {
        pen.moveTo(left - half * 0.6 * side, top - half * 0.6);
        pen.lineTo(left + half * 0.6 * side, top + half * 0.6);
      }
      pen.stroke();
    }
    if (robot.carries) {
      const size = cell * 0.24;
      pen.fillStyle = theme.warn;
      pen.strokeStyle = theme.surface;
      pen.lineWidth = 1;
      pen.beginPath();
      pen.roundRect(x + radius * 0.35, y - radius * 1.05, size, size * 0.8, size * 0.16);
      pen.fill();
      pen.stroke();
    }
    if (robot.path === this.selected) this.#ring(pen, x, y, radius + 3);
    pen.globalAlpha = 1;
  }

  #ring(pen, x, y, radius) {
    pen.strokeStyle = this.theme.accent;
    pen.lineWidth = 2;
    pen.beginPath();
    pen.arc(x, y, radius, 0, 7);
    pen.stroke();
  }
}
