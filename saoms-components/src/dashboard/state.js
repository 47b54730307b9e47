// What is on the floor, from the status of the robots and masters and from the newest messages of topics.

/** States in which a robot needs a person. */
const BROKEN = new Set(["broken", "stranded", "gone"]);
/** Conflicts that are listed after they ended. */
const KEPT = 40;
/** Seconds of a run that has ended after which what is shown does not follow from what was. */
const JUMP_S = 10;

const at = (pair) => (Array.isArray(pair) ? { x: pair[0], y: pair[1] } : (pair ?? null));
export const same = (a, b) => a !== null && b !== null && a.x === b.x && a.y === b.y;
export const place = (block) => (block ? `(${block.x},${block.y})` : "–");
/** The site of a topic, which begins with it: robots and luggage of another site may have the same numbers. */
export const siteOf = (topic) => topic.slice(0, Math.max(0, topic.lastIndexOf("/")));

export class Floor {
  constructor(fleet) {
    this.fleet = fleet;
    this.robots = new Map();
    /** What each robot said last. */
    this.said = new Map();
    this.luggage = [];
    this.conflicts = new Map();
    this.past = [];
    this.zones = [];
    this.grants = new Map();
    this.area = null;
    /** The time that was shown last. */
    this.seen = 0;
    /** The topic of positions of the site that is shown. */
    this.site = null;
  }

  /** The topics of messages of a type, those of the site that is shown. */
  topics(message) {
    const found = this.fleet.topicList.filter((topic) => topic.message === message).map((topic) => topic.name);
    return found.filter((name) => siteOf(name) === siteOf(this.site ?? ""));
  }

  /** Shows the site of this topic of positions. What was in conflict at another one is not seen from here. */
  show(site) {
    this.site = site;
    [this.conflicts, this.past] = [new Map(), []];
  }

  /** An event at the site that is shown, as `saoms send` takes it. */
  line(event) {
    const site = siteOf(this.site ?? "");
    return site ? `${site}: ${event}` : event;
  }

  /** Judges whether a component belongs to the site that is shown. Where only one has robots, all do. */
  #isHere(positions) {
    const sites = new Set(this.sites().map(siteOf));
    const here = siteOf(this.site ?? "");
    // An earlier recording does not say of which site they are.
    const of = ({ name, site }) => (site === undefined ? positions.has(name) : (sites.has(site) ? site : "") === here);
    return (one) => sites.size < 2 || of(one);
  }

  sites() {
    return this.fleet.topicList.filter((topic) => topic.message === "Position").map((topic) => topic.name);
  }

  #messages(type) {
    return this.topics(type).flatMap((topic) => [...(this.fleet.topics.get(topic)?.values() ?? [])]);
  }

  update() {
    this.site ??= this.sites()[0] ?? null;
    const now = this.fleet.state.time_s;
    // In a run that has ended, somebody may go to another moment: nobody saw what came between.
    if (this.fleet.isFinished && (now < this.seen || now > this.seen + JUMP_S)) [this.conflicts, this.past] = [new Map(), []];
    this.seen = now;
    const positions = new Map(this.#messages("Position").map((one) => [one.component, one.message]));
    const chargers = new Map(this.#messages("RobotList").map((one) => [one.component, one.message?.charger]));
    const isHere = this.#isHere(positions);
    this.#area();
    this.zones = this.#messages("Territory").map((one) => one.message);
    const robots = new Map();
    const luggage = [];
    /** What zones say of robots that wait, by the numbers of both robots and the block. */
    this.reasons = new Map();
    for (const one of this.fleet.components.values()) {
      if (!isHere(one)) continue;
      // A robot that sleeps says nothing: it stays where it was.
      const values = one.state === "idle" && !("robot" in (one.values ?? {})) ? (this.said.get(one.name) ?? {}) : (one.values ?? {});
      if (Array.isArray(values.luggage)) luggage.push(...values.luggage);
      if (Array.isArray(values.waits)) for (const wait of values.waits) this.reasons.set(`${wait.robot}/${wait.goes_first}/${place(at(wait.at))}`, wait.because);
      if (typeof values.robot !== "number" || !Array.isArray(values.block)) continue;
      const position = positions.get(one.name);
      this.said.set(one.name, values);
      const known = this.robots.get(one.name);
      const block = at(values.block);
      robots.set(one.name, {
        path: one.name,
        number: values.robot,
        state: one.emergency_stop ? "stopped" : one.state === "running" ? values.state : one.state === "idle" ? "off" : one.state,
        isBroken: BROKEN.has(values.state) || one.state === "failed",
        isStopped: one.emergency_stop,
        isOff: one.state !== "running",
        isStale: this.fleet.isStale(one),
        component: one,
        battery: values.battery,
        job: values.job,
        // One that is stopped says that alone.
        carries: /^carries/.test(values.state) || (values.state === "stopped" && known?.carries === true),
        delivered: values.delivered,
        block: position?.block ?? block,
        next: position?.next ?? block,
        wanted: position?.wanted ?? block,
        charger: chargers.get(one.name) ?? null,
        waitsFor: values.waits_for_robot,
        since: values.waits_since_s,
        waitsAt: at(values.waits_at),
        goesFirst: values.goes_first,
        because: values.because,
        // Where it is drawn: it glides to its block.
        drawn: known?.drawn ?? { ...(position?.block ?? block) },
      });
    }
    this.robots = robots;
    this.byNumber = new Map([...robots.values()].map((robot) => [robot.number, robot]));
    this.#luggage(luggage);
    this.grants = new Map();
    for (const { message } of this.#messages("Grant")) {
      const steps = this.grants.get(message.robot) ?? [];
      steps.push(...message.steps.map((step) => step.block));
      this.grants.set(message.robot, steps);
    }
    this.#conflicts();
  }

  #area() {
    const [found] = this.#messages("Area");
    if (found) {
      const { width, height, blocked } = found.message;
      if (this.area?.source !== found) {
        const bits = blocked.map(BigInt);
        const isBlocked = (x, y) => {
          const index = y * width + x;
          return ((bits[index >> 6] ?? 0n) >> BigInt(index & 63)) & 1n;
        };
        const blocks = [];
        for (let y = 0; y < height; y++) for (let x = 0; x < width; x++) if (isBlocked(x, y)) blocks.push({ x, y });
        this.area = { source: found, width, height, blocked: blocks };
      }
      return;
    }
    // Without a world, the floor reaches as far as somebody is.
    const blocks = [...this.robots.values()].flatMap((robot) => [robot.block, robot.charger, robot.wanted]).concat(this.luggage.flatMap((one) => [one.from, one.to]));
    const side = (of) => Math.max(5, ...blocks.filter(Boolean).map(of)) + 1;
    this.area = { source: null, width: side((block) => block.x), height: side((block) => block.y), blocked: [] };
  }

  #luggage(listed) {
    const carriers = new Map();
    for (const robot of this.robots.values()) {
      const [, number] = /^luggage (\d+) /.exec(robot.job ?? "") ?? [];
      if (number) carriers.set(Number(number), robot);
    }
    this.luggage = listed.map((one) => {
      const robot = carriers.get(one.luggage) ?? null;
      const isCarried = robot !== null && robot.carries;
      return { number: one.luggage, from: at(one.from), to: at(one.to), waits: one.waits, robot, isCarried };
    });
  }

  /** Robots that wait for another one, with who goes first, and why: what they say, or the zone that decides. */
  #conflicts() {
    const now = new Map();
    for (const robot of this.robots.values()) {
      const other = this.byNumber.get(robot.waitsFor);
      if (!other || robot.isOff) continue;
      const key = `${robot.path}/${other.path}/${robot.since}`;
      const winner = this.byNumber.get(robot.goesFirst) ?? other;
      const reason = this.reasons.get(`${robot.number}/${winner.number}/${place(robot.waitsAt)}`) ?? robot.because ?? "";
      now.set(key, { key, robot: robot.path, other: other.path, winner: winner.path, block: robot.waitsAt, since: robot.since, reason, until: null });
    }
    for (const [key, one] of this.conflicts) {
      if (now.has(key)) continue;
      this.past.unshift({ ...one, until: this.fleet.state.time_s });
      this.past.length = Math.min(this.past.length, KEPT);
    }
    this.conflicts = now;
  }
}
