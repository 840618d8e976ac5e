// Hosts an FMI 2.0 co-simulation FMU that is a WebAssembly module. Knows no model: all comes from its description.

const OK = 0, WARNING = 1, DISCARD = 2; // fmi2Status
const CO_SIMULATION = 1; // fmi2Type
const NO_FILE = 8; // WASI's "bad file descriptor": an FMU finds no folder here

/** The FMU refused a call; the message is the FMU's own. */
export class FmuError extends Error {}
/** A communication step could not be solved; the instance is as before the step. */
export class StepDiscarded extends FmuError {}

// (module (import "e" "f" (func (param i32 i32 i32 i32 i32 i32))) (export "f" (func 0))): fmi2CallbackLogger, whose
// further arguments are one pointer. Its export is a function that the FMU's table takes, which a JavaScript one is not.
const LOGGER = Uint8Array.from([
  ...[0, 0x61, 0x73, 0x6d, 1, 0, 0, 0],
  ...[1, 10, 1, 0x60, 6, 0x7f, 0x7f, 0x7f, 0x7f, 0x7f, 0x7f, 0],
  ...[2, 7, 1, 1, 0x65, 1, 0x66, 0, 0],
  ...[7, 5, 1, 1, 0x66, 0, 0],
]);

function wasi() {
  const leave = (status) => {
    throw new FmuError(`the FMU ended itself with status ${status}`);
  };
  return new Proxy({}, { get: (_, name) => (name === "proc_exit" ? leave : () => NO_FILE) });
}

/** An FMU in memory of its own. */
export class Fmu {
  /** bytes: of the module; description: from readDescription. A promise. */
  static async load(bytes, description) {
    const module = await WebAssembly.compile(bytes);
    const imports = Object.fromEntries(WebAssembly.Module.imports(module).map((needed) => [needed.module, wasi()]));
    return new Fmu((await WebAssembly.instantiate(module, imports)).exports, description);
  }

  constructor(exports, description) {
    this.exports = exports;
    this.description = description;
    this.messages = []; // of the call that runs, by the logger
    this.warnings = new Set(); // messages that came without a refusal
    exports._initialize?.();
    const log = (_environment, _name, _status, _category, message) =>
      this.messages.push(this.text(message).replaceAll("%%", "%"));
    const logger = new WebAssembly.Instance(new WebAssembly.Module(LOGGER), { e: { f: log } }).exports.f;
    const table = exports.__indirect_function_table;
    const place = table.grow(1);
    table.set(place, logger);
    this.callbacks = exports.malloc(20); // logger, allocateMemory, freeMemory, stepFinished, componentEnvironment
    new Uint32Array(exports.memory.buffer, this.callbacks, 5).set([place, 0, 0, 0, 0]);
  }

  /** Bytes of the FMU's memory. */
  get size() {
    return this.exports.memory.buffer.byteLength;
  }

  text(pointer) {
    const bytes = new Uint8Array(this.exports.memory.buffer);
    return new TextDecoder().decode(bytes.subarray(pointer, bytes.indexOf(0, pointer)));
  }

  /** What `use` returns of a pointer to this text, which it has meanwhile. */
  withText(text, use) {
    const bytes = new TextEncoder().encode(`${text}\0`);
    const pointer = this.exports.malloc(bytes.length);
    new Uint8Array(this.exports.memory.buffer).set(bytes, pointer);
    try {
      return use(pointer);
    } finally {
      this.exports.free(pointer);
    }
  }

  /** Calls fmi2NAME. Throws FmuError or StepDiscarded, with what the FMU logged, unless it is fine. */
  call(name, ...values) {
    this.messages.length = 0;
    const status = this.exports[`fmi2${name}`](...values);
    if (status === OK || status === WARNING) {
      for (const message of this.messages) this.warnings.add(message);
      return;
    }
    const message = this.messages.join("; ") || `fmi2${name} was refused with status ${status}`;
    throw status === DISCARD ? new StepDiscarded(message) : new FmuError(message);
  }

  variable(name) {
    const variable = this.description.variables.get(name);
    if (!variable) throw new FmuError(`there is no variable ${name}`);
    return variable;
  }

  instantiate(name = "instance") {
    return new Instance(this, name);
  }
}

const SETTERS = { Real: "SetReal", Integer: "SetInteger", Enumeration: "SetInteger", Boolean: "SetBoolean" };
const GETTERS = { Real: "GetReal", Integer: "GetInteger", Enumeration: "GetInteger", Boolean: "GetBoolean" };

/** One instance of an FMU; `free` it. Values are numbers, booleans, or names of an enumeration's items. */
class Instance {
  constructor(fmu, name) {
    this.fmu = fmu;
    this.used = false; // since instantiated or reset
    this.own = fmu.exports.malloc(16); // one reference, one value
    fmu.messages.length = 0;
    this.component = fmu.withText(name, (label) =>
      fmu.withText(fmu.description.guid, (guid) =>
        fmu.withText("", (nowhere) =>
          fmu.exports.fmi2Instantiate(label, CO_SIMULATION, guid, nowhere, fmu.callbacks, 0, 0),
        ),
      ),
    );
    if (!this.component) throw new FmuError(fmu.messages.join("; ") || "the FMU makes no instance");
  }

  call(name, ...values) {
    this.fmu.call(name, this.component, ...values);
  }

  /** From the beginning, at time 0, with these parameters and inputs by name. */
  start(parameters = {}, inputs = {}) {
    if (this.used) this.call("Reset");
    this.used = true;
    this.set(parameters);
    this.call("SetupExperiment", 0, 0, 0, 0, 0);
    this.call("EnterInitializationMode");
    this.set(inputs);
    this.call("ExitInitializationMode");
  }

  set(values) {
    for (const [name, value] of Object.entries(values)) {
      const { type, reference, items } = this.fmu.variable(name);
      const number = typeof value === "string" ? items.find((item) => item.name === value)?.value : Number(value);
      if (number === undefined)
        throw new FmuError(`${name} = ${value}: must be one of ${items.map((item) => item.name).join(", ")}`);
      const view = new DataView(this.fmu.exports.memory.buffer, this.own, 16);
      view.setUint32(0, reference, true);
      if (type === "Real") view.setFloat64(8, number, true);
      else view.setInt32(8, number, true);
      this.call(SETTERS[type], this.own, 1, this.own + 8);
    }
  }

  /** Values as numbers, of variables of any type. */
  get(names) {
    return names.map((name) => {
      const { type, reference } = this.fmu.variable(name);
      new DataView(this.fmu.exports.memory.buffer).setUint32(this.own, reference, true);
      this.call(GETTERS[type], this.own, 1, this.own + 8);
      const view = new DataView(this.fmu.exports.memory.buffer, this.own, 16);
      return type === "Real" ? view.getFloat64(8, true) : view.getInt32(8, true);
    });
  }

  /** These Real variables, to be set and got together, many times; `free` it. */
  reals(names) {
    return new Reals(this, names);
  }

  step(time, size) {
    this.call("DoStep", time, size, 1);
  }

  /** A handle of the state, for `restore`; `forget` it. */
  save() {
    const handle = this.fmu.exports.malloc(4);
    new DataView(this.fmu.exports.memory.buffer).setUint32(handle, 0, true);
    this.call("GetFMUstate", handle);
    return handle;
  }

  restore(handle) {
    this.call("SetFMUstate", new DataView(this.fmu.exports.memory.buffer).getUint32(handle, true));
  }

  forget(handle) {
    this.call("FreeFMUstate", handle);
    this.fmu.exports.free(handle);
  }

  free() {
    this.fmu.exports.fmi2FreeInstance(this.component);
    this.fmu.exports.free(this.own);
  }
}

class Reals {
  constructor(instance, names) {
    this.instance = instance;
    this.count = names.length;
    const variables = names.map((name) => instance.fmu.variable(name));
    for (const { name, type } of variables) if (type !== "Real") throw new FmuError(`${name} is no Real`);
    this.references = instance.fmu.exports.malloc(4 * this.count);
    this.pointer = instance.fmu.exports.malloc(8 * this.count);
    new Uint32Array(instance.fmu.exports.memory.buffer, this.references, this.count).set(
      variables.map(({ reference }) => reference),
    );
  }

  /** A view that is good until the FMU's memory grows: copy what is to be kept. */
  get values() {
    return new Float64Array(this.instance.fmu.exports.memory.buffer, this.pointer, this.count);
  }

  set(values) {
    this.values.set(values);
    this.instance.call("SetReal", this.references, this.count, this.pointer);
  }

  get() {
    this.instance.call("GetReal", this.references, this.count, this.pointer);
    return this.values;
  }

  free() {
    this.instance.fmu.exports.free(this.references);
    this.instance.fmu.exports.free(this.pointer);
  }
}
