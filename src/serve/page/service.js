// The service: requests, and its refusals as sentences.

/** A text as a sentence: with a capital letter and a full stop. */
function sentence(text) {
  const trimmed = text.trim();
  const ends = /[.!?]$/.test(trimmed);
  return trimmed.charAt(0).toUpperCase() + trimmed.slice(1) + (ends ? "" : ".");
}

/** A reply of the service to a path below its own; throws an Error whose message is a sentence. */
async function reply(path, signal) {
  let answer;
  try {
    answer = await fetch(new URL(path, document.baseURI), { signal });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Error("The service does not answer. Is it still running?");
  }
  if (answer.ok) return answer;
  let reason = `the service answered ${answer.status}`;
  try {
    reason = (await answer.json()).error ?? reason;
  } catch {
    // Something between the page and the service has answered.
  }
  const error = new Error(sentence(reason));
  error.retryAfter = Number(answer.headers.get("retry-after")) || 0;
  throw error;
}

/** The JSON that the service answers to these parameters. */
async function ask(path, parameters, signal) {
  const answer = await reply(`${path}?${new URLSearchParams(parameters)}`, signal);
  return answer.json();
}

const path_of = (dataset) => `v1/${encodeURIComponent(dataset.name)}`;

/** A place as requests have it: what is shown is what is asked. */
const written = (at) => `${at.lat},${at.lng}`;

/** A place that is rounded to 0.1 m. */
const place = (lat, lng) => ({ lat: Number(lat.toFixed(6)), lng: Number((((lng + 540) % 360) - 180).toFixed(6)) });

/** The height of a place, and its position as UTM and as a grid reference. */
async function described(dataset, at, signal) {
  const asked = (positions) => ask(path_of(dataset), { locations: written(at), positions }, signal);
  const [utm, mgrs] = await Promise.all([asked("utm"), asked("mgrs")]);
  const { elevation, status, vertical_datum: datum, location } = utm.results[0];
  return { elevation, status, datum, utm: location.position, mgrs: mgrs.results[0].location.position };
}

/** The place that a text names, in any form that the service reads. */
async function place_of(dataset, text, signal) {
  const { results } = await ask(path_of(dataset), { locations: text }, signal);
  if (results.length !== 1) throw new Error("Write one place.");
  return place(results[0].location.lat, results[0].location.lng);
}

/** Degrees on WGS 84, as a text. */
function degrees({ lat, lng }) {
  const part = (value, letters) => `${Math.abs(value).toFixed(6)}° ${letters[value < 0 ? 1 : 0]}`;
  return `${part(lat, "NS")}, ${part(lng, "EW")}`;
}

/** The place of a text of `positions=dd`. */
function place_of_degrees(text) {
  const found = /^(\d+(?:\.\d+)?)°?\s*([NS]),?\s*(\d+(?:\.\d+)?)°?\s*([EW])$/.exec(text ?? "");
  if (!found) return null;
  const sign = (letter) => (letter === "S" || letter === "W" ? -1 : 1);
  return { lat: Number(found[1]) * sign(found[2]), lng: Number(found[3]) * sign(found[4]) };
}

const meters = (value) => (Math.abs(value) < 1e4 ? `${value.toFixed(1)} m` : `${(value / 1000).toFixed(2)} km`);
