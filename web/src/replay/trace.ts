// The path of a tip, coloured by its error. Its numbers are sent to the graphics card once per test
// case; later only the drawn range changes. Earlier moves are thin and pale, because wide lines
// take long if the processor draws them.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  Group,
  InstancedInterleavedBuffer,
  InterleavedBufferAttribute,
  Line,
  LineBasicMaterial,
  Sphere,
  Vector3,
} from 'three';
import { Line2 } from 'three/addons/lines/Line2.js';
import { LineGeometry } from 'three/addons/lines/LineGeometry.js';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import type { Rgb } from './colours';

const kFaint = 0.4; // share of the background colour

// Each piece has both its ends: piece i goes from moment i to i + 1.
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
  private readonly past: Line<BufferGeometry, LineBasicMaterial>;
  private readonly now: Line2;
  private first = -1;

  // `tip_m` has 3 numbers per moment. `colour` gives the colour of each moment.
  constructor(tip_m: Float32Array, colour: (moment: number) => Rgb, width: number, background: string) {
    const moments = tip_m.length / 3;
    const colours = new Float32Array(3 * moments);
    const faint = new Float32Array(3 * moments);
    const linear = new Color();
    const ground = new Color(background);
    for (let i = 0; i < moments; ++i) {
      linear.setRGB(...colour(i), 'srgb').toArray(colours, 3 * i);
      linear.lerp(ground, kFaint).toArray(faint, 3 * i);
    }
    this.positions = make_pieces(tip_m, moments);
    this.colours = make_pieces(colours, moments);

    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(tip_m, 3));
    geometry.setAttribute('color', new BufferAttribute(faint, 3));
    this.past = new Line(geometry, new LineBasicMaterial({ vertexColors: true }));
    this.past.frustumCulled = false; // an arm that runs away has no useful extent

    // The current move is drawn through the arm and its load, which otherwise hide the tip.
    const material = new LineMaterial({ linewidth: width, vertexColors: true, transparent: true, depthTest: false });
    this.now = new Line2(new LineGeometry(), material);
    this.now.renderOrder = 1;
    // A range that begins later seems to go beyond the end of the numbers, so three must not
    // compute its extent.
    this.now.frustumCulled = false;
    this.now.geometry.boundingSphere = new Sphere(new Vector3(0, 0, 1), 5);
    this.group.add(this.past, this.now);
  }

  show(parts: { past: [number, number]; now: [number, number] }): void {
    this.past.visible = parts.past[1] > parts.past[0];
    this.past.geometry.setDrawRange(parts.past[0], parts.past[1] - parts.past[0] + 1);
    const [first, last] = parts.now;
    this.now.visible = last > first;
    this.now.geometry.instanceCount = last - first;
    if (this.now.visible && this.first !== first) {
      this.first = first;
      set_range(this.now, '', this.positions, first);
      set_range(this.now, 'Color', this.colours, first);
    }
  }

  dispose(): void {
    for (const line of [this.past, this.now]) {
      line.geometry.dispose();
      line.material.dispose();
    }
  }
}
