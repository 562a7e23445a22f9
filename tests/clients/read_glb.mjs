// Plays a GLB in three.js and prints the positions of its first vertices at every frame, as JSON.
//   node read_glb.mjs '{"glb": FILE, "fps": 24, "frames": [1, 2], "vertices": 100}'
// The first of the frames is at second 0. Positions are those of the mesh, and in the world that its nodes place it in.
import { readFileSync } from 'node:fs';
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const settings = JSON.parse(process.argv[2]);
const bytes = readFileSync(settings.glb);
const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
const gltf = await new Promise((done, failed) => new GLTFLoader().parse(buffer, '', done, failed));

const meshes = [];
gltf.scene.traverse((object) => { if (object.isMesh) meshes.push(object); });
if (meshes.length !== 1) throw new Error(`${meshes.length} meshes instead of 1`);
if (gltf.animations.length !== 1) throw new Error(`${gltf.animations.length} animations instead of 1`);
const [mesh] = meshes;

const mixer = new THREE.AnimationMixer(gltf.scene);
const action = mixer.clipAction(gltf.animations[0]);
action.setLoop(THREE.LoopOnce);
action.clampWhenFinished = true;
action.play();

const frames = {};
for (const frame of settings.frames) {
  mixer.setTime((frame - settings.frames[0]) / settings.fps);
  gltf.scene.updateMatrixWorld(true);
  const mine = Array.from({ length: settings.vertices }, (_, v) => mesh.getVertexPosition(v, new THREE.Vector3()));
  const world = mine.map((p) => p.clone().applyMatrix4(mesh.matrixWorld));
  frames[frame] = { mesh: mine.map((p) => p.toArray()), world: world.map((p) => p.toArray()) };
}
console.log(JSON.stringify({ revision: THREE.REVISION, frames }));
