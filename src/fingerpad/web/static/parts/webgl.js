// Shaded triangles by WebGL.

const VERTEX = `#version 300 es
in vec3 position; in vec3 normal;
uniform mat4 place; uniform mat3 turn;
out vec3 facing; out vec3 where;
void main() { facing = turn * normal; where = position; gl_Position = place * vec4(position, 1.0); }`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec3 facing; in vec3 where;
uniform vec4 colour; uniform float rings; uniform vec3 back; uniform float cut;
out vec4 result;
void main() {
  vec3 n = normalize(facing);
  if (n.z < 0.0) n = -n;
  float light = 0.46 + 0.42 * max(dot(n, normalize(vec3(-0.45, 0.65, 0.72))), 0.0) + 0.16 * n.z;
  vec3 base = where.x < cut ? back : colour.rgb;
  if (rings > 0.0) {
    float rim = pow(1.0 - abs(n.z), 3.0);
    base = mix(base, base * 0.72, rim);
  }
  result = vec4(base * light * colour.a, colour.a);
}`;

function compile(gl, kind, source) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
}

export class Painter {
  /** Return a painter, or null where WebGL is missing. */
  static on(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, premultipliedAlpha: true });
    if (!gl) return null;
    try {
      return new Painter(gl);
    } catch {
      return null;
    }
  }

  constructor(gl) {
    this.gl = gl;
    const program = gl.createProgram();
    gl.attachShader(program, compile(gl, gl.VERTEX_SHADER, VERTEX));
    gl.attachShader(program, compile(gl, gl.FRAGMENT_SHADER, FRAGMENT));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    this.program = program;
    this.at = Object.fromEntries(
      ["place", "turn", "colour", "rings", "back", "cut"].map((name) => [
        name,
        gl.getUniformLocation(program, name),
      ]),
    );
    this.meshes = new Map();
  }

  /** Store a mesh: flat arrays of positions and normals, and indices of triangles. */
  keep(name, positions, normals, triangles) {
    const { gl } = this;
    const old = this.meshes.get(name);
    if (old) old.forget();
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const buffers = [positions, normals].map((values, index) => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.DYNAMIC_DRAW);
      const location = gl.getAttribLocation(this.program, index ? "normal" : "position");
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 0, 0);
      return buffer;
    });
    const indices = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(triangles), gl.DYNAMIC_DRAW);
    gl.bindVertexArray(null);
    this.meshes.set(name, {
      array,
      count: triangles.length,
      forget: () => {
        gl.deleteVertexArray(array);
        for (const buffer of [...buffers, indices]) gl.deleteBuffer(buffer);
      },
    });
  }

  begin(width, height) {
    const { gl } = this;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(this.program);
  }

  draw(name, { place, turn, colour, back = colour, cut = -1e9, rings = 0, clear = false }) {
    const { gl } = this;
    const mesh = this.meshes.get(name);
    if (!mesh) return;
    gl.depthMask(!clear);
    gl.uniformMatrix4fv(this.at.place, false, place);
    gl.uniformMatrix3fv(this.at.turn, false, turn);
    gl.uniform4f(this.at.colour, ...colour);
    gl.uniform3f(this.at.back, ...back.slice(0, 3));
    gl.uniform1f(this.at.cut, cut);
    gl.uniform1f(this.at.rings, rings);
    gl.bindVertexArray(mesh.array);
    gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_SHORT, 0);
    gl.bindVertexArray(null);
    gl.depthMask(true);
  }
}
