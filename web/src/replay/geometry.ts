// Makes the geometries of the bodies of a robot. All shapes of a body are one geometry, with their
// colours at the corners, so that drawing a body takes one call.
import {
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Color,
  CylinderGeometry,
  Float32BufferAttribute,
  Matrix4,
  SphereGeometry,
} from 'three';
import type { Mesh, Robot, Shape } from '../data';
import { unpack, unpack_indices } from '../numbers';
import { make_frame, type Frame } from './chain';

export function to_matrix(frame: Frame, matrix: Matrix4): Matrix4 {
  const f = frame;
  return matrix.set(f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8], f[9], f[10], f[11], 0, 0, 0, 1);
}

function make_mesh_geometry(mesh: Mesh, scale: [number, number, number]): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(unpack(mesh.positions), 3));
  geometry.setIndex(new BufferAttribute(unpack_indices(mesh.indices), 1));
  geometry.scale(scale[0], scale[1], scale[2]);
  const flat = geometry.toNonIndexed(); // triangles share no corners, so each has its own normal
  flat.computeVertexNormals();
  geometry.dispose();
  return flat;
}

function make_shape_geometry(shape: Shape, meshes: Mesh[]): BufferGeometry | null {
  const [a, b, c] = shape.size;
  switch (shape.kind) {
    case 'box':
      return new BoxGeometry(a, b, c);
    case 'cylinder':
      return new CylinderGeometry(a, a, b, 28).rotateX(Math.PI / 2); // its axis is y there and z here
    case 'sphere':
      return new SphereGeometry(a, 20, 12);
    case 'mesh':
      return shape.mesh === null ? null : make_mesh_geometry(meshes[shape.mesh], shape.size);
  }
}

function join(parts: { geometry: BufferGeometry; rgba: number[] }[]): BufferGeometry {
  const positions: number[] = [];
  const normals: number[] = [];
  const colours: number[] = [];
  const indices: number[] = [];
  for (const { geometry, rgba } of parts) {
    const first = positions.length / 3;
    const position = geometry.getAttribute('position');
    const normal = geometry.getAttribute('normal');
    const colour = new Color().setRGB(rgba[0], rgba[1], rgba[2], 'srgb');
    for (let i = 0; i < position.count; ++i) {
      positions.push(position.getX(i), position.getY(i), position.getZ(i));
      normals.push(normal.getX(i), normal.getY(i), normal.getZ(i));
      colours.push(colour.r, colour.g, colour.b);
    }
    const count = geometry.index?.count ?? position.count;
    for (let i = 0; i < count; ++i) {
      indices.push(first + (geometry.index?.getX(i) ?? i));
    }
    geometry.dispose();
  }
  const joined = new BufferGeometry();
  joined.setAttribute('position', new Float32BufferAttribute(positions, 3));
  joined.setAttribute('normal', new Float32BufferAttribute(normals, 3));
  joined.setAttribute('color', new Float32BufferAttribute(colours, 3));
  joined.setIndex(indices);
  return joined;
}

// Returns one geometry per body, in the frame of the body.
export function make_bodies(robot: Robot): BufferGeometry[] {
  const matrix = new Matrix4();
  return robot.bodies.map((body) => {
    const parts: { geometry: BufferGeometry; rgba: number[] }[] = [];
    for (const shape of body.shapes) {
      const geometry = make_shape_geometry(shape, robot.meshes);
      if (geometry !== null) {
        geometry.applyMatrix4(to_matrix(make_frame(shape.pose), matrix));
        parts.push({ geometry, rgba: shape.rgba });
      }
    }
    return join(parts);
  });
}
