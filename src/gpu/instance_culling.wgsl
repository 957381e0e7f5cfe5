// Which instances a view shows, and their data one behind the other: `CullingView` on the device. See `instance_culling.rs`.

struct View {
    // Position; 1 where rays are parallel.
    eye: vec4f,
    // Direction; how much the picture's half opens a meter ahead to the side.
    right: vec4f,
    up: vec4f,
    // Direction; the nearest depth, meters.
    forward: vec4f,
    // With parallel rays half of what is seen, to the side and up; the farthest depth; all in meters.
    half_and_far: vec4f,
    // Pixels of a meter, of one meter ahead where rays are not parallel; the least size in pixels.
    scale: vec4f,
}

struct InstanceBox {
    // The corner; the diagonal, or less than nothing of what is always shown.
    low: vec4f,
    high: vec4f,
}

// Up to 256 instances of a run.
struct Block {
    first: u32,
    count: u32,
    run: u32,
    // The first block of the run.
    run_block: u32,
}

override words: u32;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> boxes: array<InstanceBox>;
@group(0) @binding(2) var<storage, read> blocks: array<Block>;
@group(0) @binding(3) var<storage, read> instances: array<u32>;
@group(0) @binding(4) var<storage, read_write> counts: array<u32>;
@group(0) @binding(5) var<storage, read_write> seen: array<u32>;
// Five numbers of each call, the second the number of its instances.
@group(0) @binding(6) var<storage, read_write> calls: array<u32>;

const SIDE = 256u;

var<workgroup> sums: array<u32, SIDE>;

fn is_inside(normal: vec3f, offset: f32, low: vec3f, high: vec3f) -> bool {
    return dot(normal, select(low, high, normal >= vec3f(0.0))) + offset >= 0.0;
}

fn is_seen(index: u32) -> bool {
    let low = boxes[index].low.xyz;
    let high = boxes[index].high.xyz;
    let size_m = boxes[index].low.w;
    if size_m < 0.0 {
        return true;
    }
    let eye = view.eye.xyz;
    let forward = view.forward.xyz;
    let ahead_m = dot(forward, (low + high) * 0.5 - eye) - dot(abs(forward), high - low) * 0.5;
    let depth_m = select(max(ahead_m, view.forward.w), 1.0, view.eye.w > 0.0);
    if view.scale.x * size_m < view.scale.y * depth_m {
        return false;
    }
    let aside = forward * view.right.w;
    let above = forward * view.up.w;
    let a = aside + view.right.xyz;
    let b = aside - view.right.xyz;
    let c = above + view.up.xyz;
    let d = above - view.up.xyz;
    let half = view.half_and_far;
    return is_inside(a, half.x - dot(a, eye), low, high) && is_inside(b, half.x - dot(b, eye), low, high)
        && is_inside(c, half.y - dot(c, eye), low, high) && is_inside(d, half.y - dot(d, eye), low, high)
        && is_inside(-forward, half.z + dot(forward, eye), low, high);
}

// The sum of what all before and at `local` bring; to be called by all of a group.
fn summed(local: u32, brings: u32) -> u32 {
    sums[local] = brings;
    workgroupBarrier();
    for (var step = 1u; step < SIDE; step *= 2u) {
        var before = 0u;
        if local >= step {
            before = sums[local - step];
        }
        workgroupBarrier();
        sums[local] += before;
        workgroupBarrier();
    }
    let sum = sums[local];
    workgroupBarrier();
    return sum;
}

// Counts what is seen of each block.
@compute @workgroup_size(256)
fn count_seen(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let block = blocks[group.x];
    let shows = local < block.count && is_seen(block.first + local);
    let sum = summed(local, select(0u, 1u, shows));
    if local == SIDE - 1u {
        counts[group.x] = sum;
    }
}

// Puts what is seen of a run one behind the other, in its order, and how much that is into its call.
@compute @workgroup_size(256)
fn place_seen(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let block = blocks[group.x];
    var brings = 0u;
    for (var other = block.run_block + local; other < group.x; other += SIDE) {
        brings += counts[other];
    }
    let of_thread = summed(local, brings);
    sums[local] = of_thread;
    workgroupBarrier();
    let before = sums[SIDE - 1u];
    workgroupBarrier();
    let index = block.first + local;
    let shows = local < block.count && is_seen(index);
    let sum = summed(local, select(0u, 1u, shows));
    if shows {
        let first = blocks[block.run_block].first;
        let to = (first + before + sum - 1u) * words;
        for (var word = 0u; word < words; word++) {
            seen[to + word] = instances[index * words + word];
        }
    }
    // The last block of a run has the sum of all of them.
    let is_last = group.x + 1u == arrayLength(&blocks) || blocks[group.x + 1u].run != block.run;
    if is_last && local == SIDE - 1u {
        calls[block.run * 5u + 1u] = before + sum;
    }
}
