// As much of WASI preview 1 as the command line uses: arguments, clocks, random bytes, three streams and one folder whose files
// exist in memory only. `worker.js` follows it in the same worker.
"use strict";

const OK = 0, BAD_FILE = 8, EXISTS = 20, INVALID = 28, IS_FOLDER = 31, NONE = 44, UNSUPPORTED = 52;
const REGULAR = 4, FOLDER = 3, CHARACTERS = 2;
// The one folder, opened before the program starts, and the flags of path_open.
const ROOT = 3, CREATE = 1, DIRECTORY = 2, EXCLUSIVE = 4, TRUNCATE = 8;
// Bytes of a dropped file that are read at once.
const BLOCK = 1 << 20;

class Exit extends Error {
  constructor(status) {
    super(`exit ${status}`);
    this.status = status;
  }
}

// A file that was dropped on the page: read block by block, so that its size costs nothing before it is asked for.
class Dropped {
  constructor(blob) {
    this.blob = blob;
    this.from = 0;
    this.block = new Uint8Array(0);
  }

  get size() {
    return this.blob.size;
  }

  read(at, into) {
    let done = 0;
    while (done < into.length && at + done < this.size) {
      const start = at + done;
      if (start < this.from || start >= this.from + this.block.length) {
        this.from = start;
        this.block = new Uint8Array(new FileReaderSync().readAsArrayBuffer(this.blob.slice(start, start + BLOCK)));
      }
      const part = this.block.subarray(start - this.from, start - this.from + into.length - done);
      into.set(part, done);
      done += part.length;
    }
    return done;
  }

  write() {
    return -1;
  }

  resize() {}
}

// A file that the program writes.
class Written {
  constructor() {
    this.bytes = new Uint8Array(4096);
    this.size = 0;
  }

  read(at, into) {
    const part = this.bytes.subarray(at, Math.min(this.size, at + into.length));
    into.set(part);
    return part.length;
  }

  write(at, from) {
    const end = at + from.length;
    if (end > this.bytes.length) {
      const larger = new Uint8Array(Math.max(end, 2 * this.bytes.length));
      larger.set(this.bytes);
      this.bytes = larger;
    }
    this.bytes.set(from, at);
    this.size = Math.max(this.size, end);
    return from.length;
  }

  resize(size) {
    this.size = Math.min(this.size, size);
  }

  content() {
    return this.bytes.slice(0, this.size);
  }
}

// What the program is given of a system: arguments, clocks, random bytes, three streams and one folder.
class System {
  constructor(args, files, hear) {
    this.args = args.map((word) => new TextEncoder().encode(word + "\0"));
    this.files = new Map(files.map(({ name, blob }) => [name, new Dropped(blob)]));
    this.open = new Map();
    this.hear = hear;
    this.said = "";
    this.heard = { 1: new TextDecoder(), 2: new TextDecoder() };
    this.line = "";
  }

  // A dropped file has its name and no folder: `recordings/a.csv` of an experiment is the `a.csv` that was dropped.
  find(path) {
    if (this.files.has(path)) return path;
    const name = path.split(/[\\/]/).pop();
    return this.files.has(name) ? name : undefined;
  }

  // Standard output is kept; standard error line by line, of which progress is told at once.
  stream(fd, bytes) {
    const text = this.heard[fd].decode(bytes, { stream: true });
    if (fd === 1) {
      this.said += text;
      return;
    }
    const lines = (this.line + text).split("\n");
    this.line = lines.pop();
    for (const line of lines) {
      const told = /^progress (-|[0-9.]+) (.*)$/.exec(line);
      if (told) this.hear(told[2], told[1] === "-" ? null : Number(told[1]));
      else this.said += `${line}\n`;
    }
  }

  imports(module, memory) {
    const view = () => new DataView(memory().buffer);
    const bytes = (at, length) => new Uint8Array(memory().buffer, at, length);
    const text = (at, length) => new TextDecoder().decode(bytes(at, length)).replace(/^(\.?\/)+/, "");
    const vectors = (at, count) => Array.from({ length: count }, (_, k) => {
      const [from, length] = [view().getUint32(at + 8 * k, true), view().getUint32(at + 8 * k + 4, true)];
      return bytes(from, length);
    });
    const stat = (at, kind, size) => {
      bytes(at, 64).fill(0);
      view().setUint8(at + 16, kind);
      view().setBigUint64(at + 24, 1n, true);
      view().setBigUint64(at + 32, BigInt(size), true);
      return OK;
    };
    const lists = (words) => ({
      sizes: (count, size) => {
        view().setUint32(count, words.length, true);
        view().setUint32(size, words.reduce((sum, word) => sum + word.length, 0), true);
        return OK;
      },
      get: (pointers, at) => {
        for (const word of words) {
          view().setUint32(pointers, at, true);
          bytes(at, word.length).set(word);
          pointers += 4;
          at += word.length;
        }
        return OK;
      },
    });
    const seek = (file, offset, whence) => {
      const from = [0, file.at, file.file.size][whence];
      const at = from + Number(offset);
      if (from === undefined || at < 0) return INVALID;
      file.at = at;
      return OK;
    };
    const args = lists(this.args);
    const environment = lists([]);
    const known = {
      args_sizes_get: args.sizes,
      args_get: args.get,
      environ_sizes_get: environment.sizes,
      environ_get: environment.get,
      clock_time_get: (clock, _precision, at) => {
        const ms = clock === 0 ? Date.now() : performance.now();
        view().setBigUint64(at, BigInt(Math.round(ms * 1e6)), true);
        return OK;
      },
      clock_res_get: (_clock, at) => (view().setBigUint64(at, 1000n, true), OK),
      random_get: (at, length) => {
        for (let k = 0; k < length; k += 65536) crypto.getRandomValues(bytes(at + k, Math.min(65536, length - k)));
        return OK;
      },
      proc_exit: (status) => {
        throw new Exit(status);
      },
      sched_yield: () => OK,
      fd_prestat_get: (fd, at) => {
        if (fd !== ROOT) return BAD_FILE;
        view().setUint32(at, 0, true);
        view().setUint32(at + 4, 1, true);
        return OK;
      },
      fd_prestat_dir_name: (fd, at) => (fd === ROOT ? (bytes(at, 1).set([47]), OK) : BAD_FILE),
      fd_fdstat_get: (fd, at) => {
        const kind = fd < ROOT ? CHARACTERS : fd === ROOT ? FOLDER : REGULAR;
        if (fd > ROOT && !this.open.has(fd)) return BAD_FILE;
        bytes(at, 24).fill(0);
        view().setUint8(at, kind);
        bytes(at + 8, 16).fill(255);
        return OK;
      },
      fd_fdstat_set_flags: () => OK,
      fd_filestat_get: (fd, at) => {
        if (fd <= ROOT) return stat(at, fd === ROOT ? FOLDER : CHARACTERS, 0);
        const file = this.open.get(fd);
        return file ? stat(at, REGULAR, file.file.size) : BAD_FILE;
      },
      path_filestat_get: (_fd, _flags, path, length, at) => {
        const name = text(path, length);
        if (name === "" || name === ".") return stat(at, FOLDER, 0);
        const found = this.find(name);
        return found === undefined ? NONE : stat(at, REGULAR, this.files.get(found).size);
      },
      path_open: (_fd, _look, path, length, flags, _rights, _inheriting, _fdflags, at) => {
        let name = text(path, length);
        const folder = name === "" || name === ".";
        if (folder && !(flags & DIRECTORY)) return IS_FOLDER;
        const found = this.find(name);
        if (found !== undefined && flags & EXCLUSIVE) return EXISTS;
        if (found === undefined && !folder) {
          if (!(flags & CREATE)) return NONE;
          this.files.set(name, new Written());
        }
        name = found ?? name;
        if (flags & TRUNCATE) this.files.set(name, new Written());
        const fd = Math.max(ROOT, ...this.open.keys()) + 1;
        this.open.set(fd, { file: folder ? new Written() : this.files.get(name), at: 0 });
        view().setUint32(at, fd, true);
        return OK;
      },
      path_create_directory: () => OK,
      path_rename: (_fd, from, length, _to, name, size) => {
        const [old, fresh] = [text(from, length), text(name, size)];
        if (!this.files.has(old)) return NONE;
        this.files.set(fresh, this.files.get(old));
        this.files.delete(old);
        return OK;
      },
      path_unlink_file: (_fd, path, length) => (this.files.delete(text(path, length)) ? OK : NONE),
      fd_close: (fd) => (this.open.delete(fd) ? OK : BAD_FILE),
      fd_sync: () => OK,
      fd_datasync: () => OK,
      fd_filestat_set_size: (fd, size) => {
        const file = this.open.get(fd);
        if (!file) return BAD_FILE;
        file.file.resize(Number(size));
        return OK;
      },
      fd_seek: (fd, offset, whence, at) => {
        const file = this.open.get(fd);
        const code = file ? seek(file, offset, whence) : BAD_FILE;
        if (code === OK) view().setBigUint64(at, BigInt(file.at), true);
        return code;
      },
      fd_tell: (fd, at) => known.fd_seek(fd, 0n, 1, at),
      fd_read: (fd, at, count, total) => {
        const file = this.open.get(fd);
        if (fd !== 0 && !file) return BAD_FILE;
        let sum = 0;
        for (const into of file ? vectors(at, count) : []) {
          const read = file.file.read(file.at, into);
          file.at += read;
          sum += read;
          if (read < into.length) break;
        }
        view().setUint32(total, sum, true);
        return OK;
      },
      fd_write: (fd, at, count, total) => {
        const file = this.open.get(fd);
        if (fd !== 1 && fd !== 2 && !file) return BAD_FILE;
        let sum = 0;
        for (const from of vectors(at, count)) {
          if (file) {
            if (file.file.write(file.at, from) < 0) return BAD_FILE;
            file.at += from.length;
          } else {
            this.stream(fd, from.slice());
          }
          sum += from.length;
        }
        view().setUint32(total, sum, true);
        return OK;
      },
    };
    const wasi = {};
    for (const { module: from, name } of WebAssembly.Module.imports(module)) {
      if (from === "wasi_snapshot_preview1") wasi[name] = known[name] ?? (() => UNSUPPORTED);
    }
    return { wasi_snapshot_preview1: wasi };
  }
}
