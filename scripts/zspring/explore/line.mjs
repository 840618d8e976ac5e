// A pantograph under a line, coupled as `zspring couple` does by default: each step once, the pantograph first, with the
// wire at the end of the step as the catenary's affine map of the force. The run begins with the wire at the height that
// static_force lifts it to; this lift and the uplift force come as a half cosine over the first span (start-up "ramp").

const OWN = "pantograph[1]";

/** One pantograph along a line, by instances of both FMUs; `free` it. */
export class LineRun {
  /**
   * run: {line, pantograph: parameters by name; start, runUp in m; speed in m/s; step in s; uplift in N on upliftOn}
   * Throws FmuError where an FMU refuses something.
   */
  constructor(catenary, pantograph, run) {
    const { line, pantograph: parametersOfHead, ...journey } = run;
    Object.assign(this, { uplift: 0, upliftOn: "upper_frame" }, journey, { catenary, pantograph, steps: 0 });
    pantograph.start({ ...parametersOfHead, drive: "Wire" });
    const [staticForce] = pantograph.get(["static_force"]);
    const parameters = { "solver.energies": false, ...line, [`${OWN}.start`]: this.start };
    const inputs = { [`${OWN}.force`]: staticForce, [`${OWN}.speed`]: this.speed };
    catenary.start(parameters, inputs);
    [this.lift] = catenary.get([`${OWN}.wire_height`]);
    const exchange = { exchange: "Sequential", "exchange.step": this.step, [`${OWN}.static_force`]: staticForce };
    catenary.start({ ...parameters, ...exchange }, inputs);
    this.map = catenary.reals(["free_height", "compliance", "compliance_previous"].map((name) => `${OWN}.${name}`));
    this.onWire = catenary.reals([`${OWN}.force`]);
    this.wire = pantograph.reals(["wire_height", "wire.compliance", "wire.compliance_previous"]);
    this.push = pantograph.reals([`uplift.${this.upliftOn}`]);
    this.contact = pantograph.reals(["contact.force"]);
    this.force = this.contact.get()[0];
  }

  /** One communication step. Throws FmuError where an FMU refuses it. */
  advance() {
    const { step } = this, time = this.steps * step, share = this.share((this.steps + 1) * step);
    const [free, compliance, previous] = this.map.get();
    this.push.set([this.uplift * share]);
    this.wire.set([free + this.lift * share, compliance, previous]);
    this.pantograph.step(time, step);
    this.force = this.contact.get()[0];
    this.onWire.set([this.force]);
    this.catenary.step(time, step);
    ++this.steps;
  }

  /** Of lift and uplift at a time. */
  share(time) {
    const travelled = Math.min(1, (time * this.speed) / this.runUp);
    return 1 - 0.5 * (1 + Math.cos(Math.PI * travelled));
  }

  /** Of the pantograph, m along the line. */
  get position() {
    return this.start + this.speed * this.steps * this.step;
  }

  free() {
    for (const reals of [this.map, this.onWire, this.wire, this.push, this.contact]) reals.free();
  }
}
