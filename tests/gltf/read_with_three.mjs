// Reads a motion with three.js and prints where its joints are, as JSON: FILE.glb or FILE.bvh, then times in seconds.
import { readFileSync } from "node:fs";
import { AnimationMixer, LoopOnce, Vector3 } from "three";
import { BVHLoader } from "three/addons/loaders/BVHLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const [path, ...times] = process.argv.slice(2);

async function load() {
  const file = readFileSync(path);
  if (path.endsWith(".bvh")) {
    const { skeleton, clip } = new BVHLoader().parse(file.toString());
    return { root: skeleton.bones[0], joints: skeleton.bones, clip };
  }
  const bytes = file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength);
  const { scene, animations } = await new GLTFLoader().parseAsync(bytes, "");
  const joints = [];
  scene.traverse((node) => node.isBone && joints.push(node));
  return { root: scene, joints, clip: animations[0] };
}

const { root, joints, clip } = await load();
const mixer = new AnimationMixer(root);
const action = mixer.clipAction(clip).setLoop(LoopOnce, 1);
action.clampWhenFinished = true;
const positions = times.map((time) => {
  action.reset().play();
  mixer.setTime(Number(time));
  root.updateMatrixWorld(true);
  return Object.fromEntries(joints.map((joint) => [joint.name, joint.getWorldPosition(new Vector3()).toArray()]));
});
console.log(JSON.stringify({ duration: clip.duration, positions }));
