// Finer posts of parts of the ground, each window under the one before, laid out as `ground_posts`.
@group(0) @binding(7) var window_posts: texture_2d<u32>;

// The share of its posts from its border over which a window fades into what is coarser; not where the map ends, too.
const WINDOW_BAND = 1.0 / 16.0;
const MOST_WINDOWS = 8u;

// A place counted in the posts of a window, from its first.
fn place_in_window(at: vec2f, window: u32) -> vec2f {
    let cell = frame.ground.zw / f32(2u << window);
    return (at - frame.ground.xy) / cell - vec2f(frame.ground_windows[window].xy);
}

// How many windows are shown at a place: with a part, the last fades into the one before.
fn windows_over(at: vec2f) -> f32 {
    var over = 0.0;
    for (var window = 0u; window < MOST_WINDOWS; window += 1u) {
        let last = vec2f(frame.ground_windows[window].zw) - 1.0;
        let place = place_in_window(at, window);
        let first = vec2f(frame.ground_windows[window].xy);
        let end = vec2f(frame.ground_levels[0].xy - 1u) * f32(2u << window);
        let beyond = vec2f(1e9);
        let inside = min(
            select(place, beyond, first == vec2f(0.0)),
            select(last - place, beyond, first + last >= end),
        );
        let part = clamp(min(inside.x, inside.y) / (WINDOW_BAND * min(last.x, last.y)), 0.0, 1.0);
        let share = select(0.0, part, window < frame.window_size.x);
        over += share;
        if share < 1.0 {
            break;
        }
    }
    return over;
}

fn window_post(at: vec2u, window: u32) -> Post {
    return unpacked(textureLoad(window_posts, vec2u(at.x, at.y + window * frame.window_size.y), 0));
}

// ground_on_level in a window, which holds the place.
fn ground_in_window(at: vec2f, window: u32) -> Post {
    let size = frame.ground_windows[window].zw;
    let grid = clamp(place_in_window(at, window), vec2f(0.0), vec2f(size - 1u));
    let first = min(vec2u(grid), max(size, vec2u(2u)) - 2u);
    let next = min(first + 1u, size - 1u);
    let sw = window_post(first, window);
    let se = window_post(vec2u(next.x, first.y), window);
    let nw = window_post(vec2u(first.x, next.y), window);
    let ne = window_post(next, window);
    return between(sw, se, nw, ne, grid - vec2f(first), f32(2u << window));
}

// The ground at a level, which is below 0 for windows.
fn ground_at_level(at: vec2f, level: i32) -> Post {
    if has(WINDOWS_PART) && level < 0 {
        return ground_in_window(at, u32(-1 - level));
    }
    return ground_on_level(at, u32(level));
}
