// Elements of the page. All text is set as text: names and messages of a fleet are never read as markup.

const SVG = "http://www.w3.org/2000/svg";

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true && !name.startsWith("aria-") ? "" : String(value));
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

/** An element of HTML: attributes, listeners as `onclick`, and children, of which texts stay texts. */
export const h = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);

/** An element of SVG. */
export const s = (tag, attributes, ...children) => fill(document.createElementNS(SVG, tag), attributes, children);

/** Sets the text of an element, if it is another one. */
export function text(element, value) {
  const shown = value === null || value === undefined ? "" : String(value);
  if (element.textContent !== shown) element.textContent = shown;
}

/** Sets the classes of an element, if they are others. */
export function classes(element, value) {
  if (element.getAttribute("class") !== value) element.setAttribute("class", value);
}

/** A time of the run; `isExact` with tenths of a second. */
export function time(seconds, isExact = false) {
  if (seconds === null || seconds === undefined) return "–";
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  if (isExact) return `${time(Math.floor(seconds))}.${Math.floor(seconds * 10) % 10}`;
  const whole = Math.floor(seconds);
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  const two = (number) => String(number).padStart(2, "0");
  return hours > 0 ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
}

/** How long something is ago. */
export function ago(seconds) {
  if (seconds < 1) return "now";
  if (seconds < 60) return `${Math.floor(seconds)} s ago`;
  return seconds < 3600 ? `${Math.floor(seconds / 60)} min ago` : `${Math.floor(seconds / 3600)} h ago`;
}

/** Microseconds. */
export function micros(value) {
  if (value === null || value === undefined) return "–";
  if (value < 1000) return `${Math.round(value)} µs`;
  return value < 1e6 ? `${(value / 1000).toFixed(1)} ms` : `${(value / 1e6).toFixed(2)} s`;
}

/** A value of a status or a message, for people. */
export function shown(value) {
  if (value === null || value === undefined) return "–";
  if (value === true) return "yes";
  if (value === false) return "no";
  if (typeof value === "number") return Number.isInteger(value) ? String(value) : String(Number(value.toPrecision(6)));
  if (typeof value === "string") return value;
  if (Array.isArray(value)) {
    const isPlain = value.every((one) => typeof one !== "object" || one === null);
    return isPlain ? `(${value.map(shown).join(", ")})` : `${value.length} entries`;
  }
  const keys = Object.keys(value);
  if (keys.length === 2 && "x" in value && "y" in value) return `(${value.x}, ${value.y})`;
  return keys.map((key) => `${key} ${shown(value[key])}`).join(", ");
}

/**
 * Keeps the children of an element in step with a list: one child for each key, in the order of the list. `make` makes
 * a child for an item, `update` shows the item in its child.
 */
export function keyed(parent, items, key, make, update) {
  const known = (parent.keyed ??= new Map());
  const wanted = new Set();
  let before = null;
  for (const item of items) {
    const name = key(item);
    wanted.add(name);
    let child = known.get(name);
    if (!child) {
      child = make(item);
      known.set(name, child);
    }
    update(child, item);
    const place = before ? before.nextSibling : parent.firstChild;
    if (place !== child) parent.insertBefore(child, place);
    before = child;
  }
  for (const [name, child] of known) {
    if (wanted.has(name)) continue;
    child.remove();
    known.delete(name);
  }
}

/** Rows that are always shown as they are; of more, those that nobody sees follow a little later. */
const MANY = 200;
/** Rows above and below those that are seen, and rows that follow at once. */
const [NEAR, CHUNK] = [6, 20];

/**
 * The rows of a table, which may be very many: to lay out a thousand rows takes a browser longer than there is between two
 * frames, so that those out of sight follow in chunks. `make` makes a row for an item, `show` shows the item in its row.
 */
export class Rows {
  constructor(body, make, show) {
    Object.assign(this, { body, make, show });
    this.late = new Map();
    this.timer = null;
    this.scrolled = () => this.late.size > 0 && requestAnimationFrame(() => this.#seen());
    addEventListener("scroll", this.scrolled, { capture: true, passive: true });
  }

  update(items, key) {
    const [first, last] = items.length > MANY ? this.#range() : [0, items.length];
    let place = 0;
    keyed(this.body, items, key, this.make, (row, item) => {
      if (place < first || place > last) this.late.set(row, item);
      else this.#shows(row, item);
      place += 1;
    });
    if (this.late.size > 0) this.timer ??= setInterval(() => this.#next(), 100);
  }

  close() {
    clearInterval(this.timer);
    removeEventListener("scroll", this.scrolled, { capture: true });
  }

  /** The places of the first and the last row that can be seen, and of some around them. */
  #range() {
    const height = this.body.firstElementChild?.offsetHeight || 30;
    const top = this.body.getBoundingClientRect().top;
    const clip = this.body.closest(".scroll").getBoundingClientRect();
    const [from, to] = [Math.max(0, clip.top), Math.min(innerHeight, clip.bottom)];
    return [Math.floor((from - top) / height) - NEAR, Math.ceil((to - top) / height) + NEAR];
  }

  #shows(row, item) {
    this.late.delete(row);
    this.show(row, item);
  }

  #seen() {
    const [first, last] = this.#range();
    for (let place = Math.max(0, first); place <= last; place++) {
      const row = this.body.children[place];
      if (this.late.has(row)) this.#shows(row, this.late.get(row));
    }
  }

  #next() {
    let left = CHUNK;
    for (const [row, item] of this.late) {
      if (left-- === 0) return;
      this.#shows(row, item);
    }
    clearInterval(this.timer);
    this.timer = null;
  }
}
