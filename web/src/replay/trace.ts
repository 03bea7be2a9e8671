// The path of a tip, coloured by its error. Its numbers go to the graphics card once a test case;
// as the time goes on only the range to draw changes.
import { Color, Group, InstancedInterleavedBuffer, InterleavedBufferAttribute, Sphere, Vector3 } from 'three';
import { Line2 } from 'three/addons/lines/Line2.js';
import { LineGeometry } from 'three/addons/lines/LineGeometry.js';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import type { Rgb } from './colours';

const kFaint = 0.62; // so far towards the background

// Each piece has both its ends: the i-th goes from moment i to i + 1.
function make_pieces(values: ArrayLike<number>, moments: number): InstancedInterleavedBuffer {
  const pieces = new Float32Array(6 * Math.max(0, moments - 1));
  for (let i = 0; i + 1 < moments; ++i) {
    for (let k = 0; k < 6; ++k) {
      pieces[6 * i + k] = values[3 * i + k];
    }
  }
  return new InstancedInterleavedBuffer(pieces, 6, 1);
}

function set_range(line: Line2, name: string, buffer: InstancedInterleavedBuffer, first: number): void {
  line.geometry.setAttribute(`instance${name}Start`, new InterleavedBufferAttribute(buffer, 3, 6 * first));
  line.geometry.setAttribute(`instance${name}End`, new InterleavedBufferAttribute(buffer, 3, 6 * first + 3));
}

export class Trace {
  readonly group = new Group();
  private readonly positions: InstancedInterleavedBuffer;
  private readonly colours: InstancedInterleavedBuffer;
  private readonly faint_colours: InstancedInterleavedBuffer;
  private readonly past: Line2;
  private readonly now: Line2;
  private readonly first = new Map<Line2, number>();

  // `tip_m` has 3 numbers a moment, `colour` gives each moment's.
  constructor(tip_m: Float32Array, colour: (moment: number) => Rgb, width: number, background: string) {
    const moments = tip_m.length / 3;
    this.positions = make_pieces(tip_m, moments);
    const colours = new Float32Array(3 * moments);
    const faint = new Float32Array(3 * moments);
    const linear = new Color();
    const ground = new Color(background);
    for (let i = 0; i < moments; ++i) {
      linear.setRGB(...colour(i), 'srgb').toArray(colours, 3 * i);
      linear.lerp(ground, kFaint).toArray(faint, 3 * i);
    }
    this.colours = make_pieces(colours, moments);
    // Not by opacity: where pieces overlap the line would be darker.
    this.faint_colours = make_pieces(faint, moments);
    this.past = this.make_line(width, true);
    this.now = this.make_line(width, false);
  }

  show(parts: { past: [number, number]; now: [number, number] }): void {
    this.set_part(this.past, parts.past);
    this.set_part(this.now, parts.now);
  }

  dispose(): void {
    for (const line of [this.past, this.now]) {
      line.geometry.dispose();
      line.material.dispose();
    }
  }

  // The move under way is seen through the arm and its load, which else hide the tip.
  private make_line(width: number, is_past: boolean): Line2 {
    const material = new LineMaterial({ linewidth: width, vertexColors: true, transparent: !is_past, depthTest: is_past });
    const line = new Line2(new LineGeometry(), material);
    line.renderOrder = is_past ? 0 : 1;
    // A range that begins later seems to go beyond the numbers' end, so its extent is not for three to find.
    line.frustumCulled = false;
    line.geometry.boundingSphere = new Sphere(new Vector3(0, 0, 1), 5);
    this.group.add(line);
    return line;
  }

  private set_part(line: Line2, [first, last]: [number, number]): void {
    line.visible = last > first;
    line.geometry.instanceCount = last - first;
    if (line.visible && this.first.get(line) !== first) {
      this.first.set(line, first);
      set_range(line, '', this.positions, first);
      set_range(line, 'Color', line === this.past ? this.faint_colours : this.colours, first);
    }
  }
}
