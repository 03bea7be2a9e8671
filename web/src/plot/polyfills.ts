// Functions that the figures need and Duktape 2.7 lacks: parts of the language newer than ES5, from
// core-js, and functions of browsers, as far as ECharts uses them.
import 'core-js/es/array/fill';
import 'core-js/es/array/find';
import 'core-js/es/array/find-index';
import 'core-js/es/array/flat';
import 'core-js/es/array/flat-map';
import 'core-js/es/array/from';
import 'core-js/es/array/includes';
import 'core-js/es/array/sort'; // Duktape does not keep the order of equal items
import 'core-js/es/map';
import 'core-js/es/math';
import 'core-js/es/object/entries';
import 'core-js/es/object/from-entries';
import 'core-js/es/object/values';
import 'core-js/es/set';
import 'core-js/es/string/pad-end';
import 'core-js/es/string/pad-start';
import 'core-js/es/typed-array/methods';

const world = globalThis as unknown as Record<string, unknown>;
world.global = world;
world.self = world;
// A figure is drawn in one call, so timers never run.
world.setTimeout = () => 0;
world.clearTimeout = () => undefined;
world.console = { log() {}, warn() {}, error() {} };
