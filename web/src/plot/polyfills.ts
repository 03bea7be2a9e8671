// What ECharts and the figures expect of their surroundings, and Duktape 2.7 lacks: ES5 with some
// of what came later, without a browser's timers.
const world = globalThis as unknown as Record<string, unknown>;
world.global = world;
world.self = world;
world.setTimeout = () => 0;
world.clearTimeout = () => undefined;
world.console = { log() {}, warn() {}, error() {} };

function add(owner: object, name: string, value: unknown): void {
  if (!(name in owner)) {
    Object.defineProperty(owner, name, { value, writable: true, configurable: true });
  }
}

[Float64Array, Float32Array, Int32Array, Uint32Array, Int16Array, Uint16Array, Uint8Array].forEach((type) => {
  add(type.prototype, 'sort', function (this: Float64Array, compare?: (a: number, b: number) => number) {
    const sorted = Array.prototype.slice.call(this).sort(compare ?? ((a: number, b: number) => a - b));
    this.set(sorted);
    return this;
  });
});
