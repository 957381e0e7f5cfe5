// Sections of numbers, packed as container.rs packs them.

function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let index = 0; index < letters.length; index += 1) bytes[index] = letters.charCodeAt(index);
  return bytes;
}

class Sections {
  constructor(bytes, places) {
    this.all = bytes;
    this.places = places;
  }

  raw({ section }) {
    const [at, length] = this.places[section];
    return this.all.subarray(at, at + length);
  }

  async inflated(section) {
    const stream = new Blob([this.raw(section)]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  async bytes(section) {
    const bytes = await this.inflated(section);
    for (let index = section.stride; index < bytes.length; index += 1) bytes[index] += bytes[index - section.stride];
    return bytes;
  }

  async words(section) {
    const { count, stride } = section;
    const planes = await this.inflated(section);
    const words = new Uint32Array(count);
    for (let index = 0; index < count; index += 1) {
      words[index] = planes[index] | (planes[count + index] << 8) | (planes[2 * count + index] << 16)
        | (planes[3 * count + index] << 24);
    }
    for (let index = stride; index < count; index += 1) words[index] += words[index - stride];
    return words;
  }

  async floats(section) {
    return new Float32Array((await this.words(section)).buffer);
  }

  // Sections that several things share, such as the places of all parts of a model, are unpacked once.
  shared(kind, section) {
    this.kept ??= new Map();
    const [at] = this.places[section.section];
    if (!this.kept.has(at)) this.kept.set(at, this[kind](section));
    return this.kept.get(at);
  }
}
