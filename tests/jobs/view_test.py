"""Pictures that are looked at while they grow: the page of --view, what it keeps to itself, and the viewer of --display."""
import base64
import http.client
import json
import os
import re
import select
import shutil
import socket
import struct
import subprocess
import threading
import time
import zlib

from rayfarm_job import ENVIRONMENT, Job, JobTest, JobTestAlone, RAYFARM, SCENES, main

SCENE = SCENES / "primitives.yaml"
SIZE = ["--size", "200x150"]
# Some seconds of two processors.
SLOW = ["--processor-time", "0.00004"]
URL = re.compile(r"look at http://127\.0\.0\.1:(\d+)/([0-9a-f]{32})/")


def read_png(path):
    """Width, height and rows of a PNG of 8 bits and three channels, as Rayfarm writes them."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert (depth, colour) in ((8, 2), (8, 6)), (depth, colour)
            channels = 3 if colour == 2 else 4
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    raw, stride = zlib.decompress(packed), channels * width
    above, rows = bytearray(stride), []
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a, b, c = row[i - channels] if i >= channels else 0, above[i], above[i - channels] if i >= channels else 0
            if kind == 1:
                row[i] = (row[i] + a) & 255
            elif kind == 2:
                row[i] = (row[i] + b) & 255
            elif kind == 3:
                row[i] = (row[i] + (a + b) // 2) & 255
            elif kind == 4:
                p = a + b - c
                row[i] = (row[i] + min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]) & 255
        rows.append(bytes(row))
        above = row
    if channels == 4:
        rows = [b"".join(row[i:i + 3] for i in range(0, len(row), 4)) for row in rows]
    return width, height, rows


class Page:
    """What a page knows of a job."""

    def __init__(self, port, token):
        self.port, self.token, self.since, self.frames, self.nodes, self.state, self.shares = port, token, 0, {}, set(), None, []

    def get(self, path, method="GET", headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        try:
            connection.request(method, path, headers=headers or {})
            answer = connection.getresponse()
            return answer.status, answer.read(), dict(answer.getheaders())
        finally:
            connection.close()

    def ask(self, path):
        status, body, _ = self.get(f"/{self.token}/{path}")
        assert status == 200, (path, status, body)
        return body

    def look(self):
        """As the page does twice a second; False: the job is over."""
        try:
            self.state = json.loads(self.ask("state"))
            while self.since < self.state["updates"]:
                self.draw(self.ask(f"updates?since={self.since}"))
        except OSError:
            return False
        self.shares.append(self.state["pixels_done"] / max(1, self.state["pixels_total"]))
        return self.state["stage"] != "ended"

    def draw(self, data):
        self.since, width, height, count = struct.unpack_from("<QHHI", data)
        at = 16
        for _ in range(count):
            frame, node, x, y, w, h = struct.unpack_from("<iHHHHH", data, at)
            at += 14
            assert x + w <= width and y + h <= height
            rows = self.frames.setdefault(frame, [bytearray(3 * width) for _ in range(height)])
            for row in range(y, y + h):
                rows[row][3 * x:3 * (x + w)] = data[at:at + 3 * w]
                at += 3 * w
            self.nodes.add(node)
        assert at == len(data)


class LookedAt:
    """A render in one process or under mpirun, and its page."""

    def __init__(self, ranks, *arguments):
        if ranks == 1:
            self.process = subprocess.Popen([RAYFARM, "render", *map(str, arguments)], stderr=subprocess.PIPE,
                                            stdout=subprocess.DEVNULL, text=True, env=ENVIRONMENT)
            self.lines = []
            self.reader = threading.Thread(target=lambda: self.lines.extend(self.process.stderr), daemon=True)
            self.reader.start()
            self.job = None
        else:
            self.job = Job(ranks, "render", *arguments)
            self.process, self.lines = self.job.process, self.job.lines
        end = time.monotonic() + 30
        while time.monotonic() < end:
            found = URL.search("".join(list(self.lines)))
            if found:
                self.page = Page(int(found[1]), found[2])
                return
            if self.process.poll() is not None:
                break
            time.sleep(0.01)
        raise AssertionError(f"no address was said: {''.join(self.lines)}")

    def wait(self):
        if self.job:
            return self.job.wait().code
        code = self.process.wait(timeout=90)
        self.reader.join()
        self.process.stderr.close()
        return code


class View(JobTest):
    def look(self, ranks, *arguments):
        """Renders and looks until the end; returns the page."""
        job = LookedAt(ranks, *arguments)
        while job.page.look():
            time.sleep(0.1)
        self.assertEqual(job.wait(), 0, "".join(job.lines))
        self.assertEqual(job.page.state["stage"], "ended")
        self.assertEqual(job.page.state["outcome"], "all is done")
        return job.page

    def check_picture(self, page, frame, path):
        width, height, rows = read_png(path)
        self.assertEqual(len(page.frames[frame]), height)
        for y in range(height):
            self.assertEqual(bytes(page.frames[frame][y]), rows[y], f"row {y} of frame {frame}")
        self.assertGreater(len(set(rows)), height // 2)

    def test_the_page_has_the_pixels_of_the_file(self):
        # The node's picture is that of any farm, looked at or not.
        quiet = self.folder / "quiet.png"
        self.assertEqual(self.run_alone("render", SCENE, "-o", quiet, *SIZE, "-q").code, 0)
        for ranks in (1, 3):
            out = self.folder / f"{ranks}.png"
            page = self.look(ranks, SCENE, "-o", out, *SIZE, *SLOW, "--view", "--progress", "none", *(["--local-nodes", "2"] if ranks == 1 else []))
            self.assertEqual(out.read_bytes(), quiet.read_bytes())
            self.check_picture(page, 0 if 0 in page.frames else 1, out)
            self.assertEqual(page.nodes, {1, 2})
            # It grew before our eyes.
            self.assertGreater(len({share for share in page.shares if 0 < share < 1}), 3, page.shares)
            self.assertEqual(page.shares, sorted(page.shares))

    def test_what_the_state_says(self):
        job = LookedAt(1, SCENE, "-o", self.folder / "a.png", *SIZE, *SLOW, "--view", "--progress", "none", "--local-nodes", "2")
        etas, states, speeds = [], set(), []
        while job.page.look():
            state = job.page.state
            states.add(state["stage"])
            etas.append((time.monotonic(), state["eta_s"]))
            speeds.append(state["rays_per_s"])
            time.sleep(0.1)
        ended = time.monotonic()
        self.assertEqual(job.wait(), 0)
        state = job.page.state
        self.assertIn("pictures", states)
        self.assertEqual((state["width"], state["height"], state["shown_width"], state["frames_total"], state["frames_written"]), (200, 150, 200, 1, 1))
        self.assertEqual(state["pixels_done"], 200 * 150)
        self.assertEqual(state["frames"][0]["share"], 1)
        self.assertEqual(state["not_shown"], 0)
        # Half-way, the time left is about right.
        half = [(when, eta) for when, eta in etas if eta is not None][len(etas) // 2 - 1]
        self.assertLess(abs(half[0] + half[1] - ended), 3, (half, ended))
        self.assertGreater(max(speeds), 1000)
        self.assertEqual([node["id"] for node in state["nodes"]], [1, 2])
        for node in state["nodes"]:
            self.assertIn(node["state"], ("waiting", "working"))
            self.assertGreater(node["items"], 5)
            self.assertGreater(node["rays"], 1000)
        traffic = state["traffic"]
        self.assertEqual(traffic["model_bytes_per_pixel"], 9)
        self.assertEqual(traffic["result_pixels"], 200 * 150)
        self.assertEqual(traffic["model_bytes"], 9 * 200 * 150)
        self.assertAlmostEqual(traffic["bytes_per_pixel"], traffic["result_bytes"] / traffic["result_pixels"])
        results = next(c for c in traffic["commands"] if c["command"] == "return_result")
        self.assertEqual(results["bytes"], traffic["result_bytes"])
        self.assertGreaterEqual(results["messages"], sum(node["items"] for node in state["nodes"]))

    def test_the_thesis_form_weighs_what_it_says(self):
        page = self.look(1, SCENE, "-o", self.folder / "a.png", "--size", "40x30", "--wire", "pixel", *SLOW, "--view", "--progress", "none")
        self.assertGreaterEqual(page.state["traffic"]["bytes_per_pixel"], 9)
        self.assertLess(page.state["traffic"]["bytes_per_pixel"], 10)
        self.check_picture(page, next(iter(page.frames)), self.folder / "a.png")

    def test_frames_crops_and_exr(self):
        arguments = ["--frames", "1-3", "--size", "120x90", "--crop", "20,101,10,81"]
        page = self.look(3, SCENE, "-o", self.folder / "a.#.exr", *arguments, *SLOW, "--view=0", "--progress", "none")
        self.assertEqual(self.run_alone("render", SCENE, "-o", self.folder / "a.#.png", *arguments, "-q").code, 0)
        self.assertEqual(page.state["window"], [20, 101, 10, 81])
        # 8 bits of a half float are at most one step from those of the light itself.
        for frame in (1, 2, 3):
            width, height, rows = read_png(self.folder / f"a.{frame}.png")
            self.assertEqual((width, height), (81, 71))
            off = [abs(a - b) for mine, right in zip(page.frames[frame], rows) for a, b in zip(mine, right)]
            self.assertLessEqual(max(off), 1)
            self.assertLess(sum(off), len(off) // 20)

    def test_large_pictures_are_shown_smaller(self):
        page = self.look(1, SCENE, "-o", self.folder / "a.png", "--size", "9000x24", "--view", "--progress", "none")
        self.assertEqual((page.state["shown_width"], page.state["shown_height"]), (3000, 8))
        _, _, rows = read_png(self.folder / "a.png")
        for y in range(8):
            right = b"".join(rows[3 * y][9 * x:9 * x + 3] for x in range(3000))
            self.assertEqual(bytes(next(iter(page.frames.values()))[y]), right)

    def test_zones_are_a_stage(self):
        scene = SCENES / "goral_room.yaml"
        job = LookedAt(1, scene, "-o", self.folder / "a.png", "--size", "32x32", "--lighting", "zonal", *SLOW, "--view", "--progress", "none",
                       "--samples", "1", "--max-time", "0:20")
        stages = []
        while job.page.look() and "pictures" not in stages and len(stages) < 400:
            stages.append(job.page.state["stage"])
            if stages[-1] == "zones":
                self.assertLessEqual(job.page.state["zones"]["unsent"], 1)
                if job.page.state["zones"]["rays"] > 0:
                    break
            time.sleep(0.02)
        self.assertIn("zones", stages)
        job.process.terminate()
        self.assertEqual(job.wait(), 75)

    def test_a_stopped_job_says_so(self):
        job = LookedAt(1, SCENE, "-o", self.folder / "a.png", "--size", "400x300", *SLOW, "--view", "--progress", "none")
        while job.page.look() and max(job.page.shares) < 0.1:
            time.sleep(0.05)
        job.process.terminate()
        while job.page.look():
            time.sleep(0.1)
        self.assertEqual(job.wait(), 75)
        self.assertEqual(job.page.state["stage"], "ended")
        self.assertIn("stopped", job.page.state["outcome"])

    def test_a_scene_that_is_wrong_ends_the_page(self):
        job = LookedAt(1, self.folder / "missing.yaml", "-o", self.folder / "a.png", "--view")
        self.assertEqual(job.wait(), 3)


class Closed(JobTest):
    """Nobody but who was told the address gets anything."""

    def begin(self, *arguments):
        return LookedAt(1, SCENE, "-o", self.folder / "a.png", "--size", "400x300", *SLOW, "--view", "--progress", "none", "--local-nodes", "2",
                        "--max-time", "0:40", *arguments)

    def end(self, job):
        job.process.terminate()
        self.assertEqual(job.wait(), 75, "".join(job.lines))

    def test_other_paths_and_hosts(self):
        job = self.begin()
        page, token = job.page, job.page.token
        self.assertEqual(page.get(f"/{token}/")[0], 200)
        wrong = token[:-1] + ("0" if token[-1] != "0" else "1")
        for path in ("/", "/state", "/updates?since=0", f"/{wrong}/", f"/{wrong}/state", f"/{token}", f"/{token[:-1]}/", f"/{token}x/state", f"//{token}/",
                     f"/{token.upper()}x", f"/{token}/../", f"/{token}/../../etc/passwd", f"/{token}/page.html", f"/{token}//etc/passwd",
                     f"/{token}/%2e%2e/%2e%2e/etc/passwd", "/etc/passwd", "/" + token[:16] + "/" + token[16:], f"/{token}/state/", "/favicon.ico",
                     f"/x/{token}/state", f"http://127.0.0.1:{page.port}/{token}/"):
            status, body, _ = page.get(path)
            self.assertEqual((status, body), (404, b""), path)
        for host in ("evil.example", f"evil.example:{page.port}", "127.0.0.1", "localhost", f"127.0.0.1:{page.port + 1}", f"0.0.0.0:{page.port}", ""):
            self.assertEqual(page.get(f"/{token}/state", headers={"Host": host})[0], 403, host)
        for host in (f"localhost:{page.port}", f"127.0.0.1:{page.port}"):
            self.assertEqual(page.get(f"/{token}/state", headers={"Host": host})[0], 200, host)
        for method in ("POST", "PUT", "DELETE", "HEAD", "OPTIONS", "PATCH"):
            self.assertEqual(page.get(f"/{token}/state", method)[0], 405, method)
        self.assertEqual(page.get(f"/{token}/state", "TRACE")[0] // 100, 4)
        for since in ("", "x", "-1", "1x", "99999999999999999999"):
            self.assertEqual(page.get(f"/{token}/updates?since={since}")[0], 400, since)
        status, body, headers = page.get(f"/{token}/")
        self.assertIn(b"<canvas", body)
        self.assertNotIn(b"http://", body)  # it asks for nothing from elsewhere
        self.assertNotIn(b"https://", body)
        self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
        self.assertEqual(headers["Referrer-Policy"], "no-referrer")
        self.assertEqual(headers["Cache-Control"], "no-store")
        self.assertNotIn("Access-Control-Allow-Origin", headers)
        self.end(job)

    def test_two_hosts_in_one_request(self):
        job = self.begin()
        with socket.create_connection(("127.0.0.1", job.page.port), timeout=10) as connection:
            connection.sendall(f"GET /{job.page.token}/state HTTP/1.1\r\nHost: 127.0.0.1:{job.page.port}\r\nHost: evil.example\r\n\r\n".encode())
            self.assertIn(b" 403 ", connection.recv(100))
        with socket.create_connection(("127.0.0.1", job.page.port), timeout=10) as connection:
            connection.sendall(f"GET /{job.page.token}/state HTTP/1.0\r\n\r\n".encode())
            self.assertIn(b" 403 ", connection.recv(100))
        self.end(job)

    def test_tokens_differ(self):
        tokens = set()
        for _ in range(3):
            job = LookedAt(1, self.folder / "missing.yaml", "-o", self.folder / "a.png", "--view")
            tokens.add(job.page.token)
            job.wait()
        self.assertEqual(len(tokens), 3)

    def test_nothing_but_loopback_listens(self):
        job = LookedAt(3, SCENE, "-o", self.folder / "a.png", "--size", "400x300", *SLOW, "--view", "--progress", "none", "--max-time", "0:40")
        host = job.job.pid_of_rank(0)
        told = subprocess.run(["ss", "-Hltnp"], capture_output=True, text=True, timeout=20).stdout
        addresses = [line.split()[3] for line in told.splitlines() if f"pid={host}," in line]
        self.assertEqual([a for a in addresses if a.endswith(f":{job.page.port}")], [f"127.0.0.1:{job.page.port}"], told)
        # The page adds nothing to what MPI has.
        for rank in (1, 2):
            pid = job.job.pid_of_rank(rank)
            self.assertNotIn(f":{job.page.port} ", "".join(line for line in told.splitlines() if f"pid={pid}," in line))
        job.process.terminate()
        job.wait()

    def test_a_port_in_use(self):
        first = self.begin()
        begin = time.monotonic()
        second = self.run_alone("render", SCENE, "-o", self.folder / "b.png", "--view", first.page.port)
        self.assertEqual(second.code, 2, second.stderr)
        self.assertLess(time.monotonic() - begin, 3)
        self.assertIn(f"127.0.0.1:{first.page.port} (Address already in use)", second.stderr)
        self.assertFalse((self.folder / "b.png").exists())
        self.assertTrue(first.page.look())  # it is its page still
        self.end(first)

    def test_words_that_are_no_port(self):
        for words in (["--view", "70000"], ["--view", "x"], ["--view", str(SCENE)], ["--view=-1"]):
            result = self.run_alone("render", *words, SCENE, "-o", self.folder / "a.png")
            self.assertEqual(result.code, 2, words)
            self.assertIn("a port is a number", result.stderr)

    def test_hostile_requests_disturb_nothing(self):
        arguments = [SCENE, "-o", self.folder / "a.png", "--size", "240x180", "--processor-time", "0.0003", "--progress", "none", "--local-nodes", "2"]
        job = LookedAt(1, *arguments, "--view")
        port, token = job.page.port, job.page.token
        head = f"GET /{token}/state HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n"
        hostile = [b"", b"GET", b"\0" * 5000, b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 100000, b"GET /" + b"a" * 200000, b"\r\n" * 1000,
                   head.encode() + b"Range: bytes=" + b"0-1," * 5000 + b"\r\n\r\n", head.encode() + b"X: " + b"a" * 20000,
                   f"POST /{token}/state HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: 99999999999\r\n\r\n".encode() + b"z" * 100000,
                   b"GET /%ff%00%zz HTTP/1.1\r\nHost: x\r\n\r\n"]
        open_ones = []
        for _ in range(4):
            for text in hostile:
                try:
                    connection = socket.create_connection(("127.0.0.1", port), timeout=0.1)
                    open_ones.append(connection)
                    connection.sendall(text)
                except OSError:
                    pass
        threads = len(os.listdir(f"/proc/{job.process.pid}/task"))
        descriptors = len(os.listdir(f"/proc/{job.process.pid}/fd"))
        self.assertLess(threads, 25)
        self.assertLess(descriptors, 80)
        for connection in open_ones:
            connection.close()
        # Who is polite is served again.
        end = time.monotonic() + 20
        while time.monotonic() < end:
            try:
                if job.page.get(f"/{token}/state")[0] == 200:
                    break
            except OSError:
                time.sleep(0.2)
        else:
            self.fail("the page is not served any more")
        self.assertIsNone(job.process.poll())
        # Some stay to the end, and say a byte now and then: the process ends all the same.
        slow = [socket.create_connection(("127.0.0.1", port), timeout=5) for _ in range(20)]
        stop = threading.Event()

        def drip():
            while not stop.wait(0.5):
                for connection in slow:
                    try:
                        connection.send(b"G")
                    except OSError:
                        pass
        dripping = threading.Thread(target=drip)
        dripping.start()
        code = job.wait()
        stop.set()
        dripping.join()
        for connection in slow:
            connection.close()
        self.assertEqual(code, 0)
        self.assertEqual(self.run_alone("render", *arguments[:1], "-o", self.folder / "b.png", "--size", "240x180", "-q").code, 0)
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())


class Chromium:
    """A browser without a window, told what to do through a pipe (its DevTools protocol)."""

    def __init__(self, program, folder, address):
        ours, theirs = os.pipe(), os.pipe()  # to it, and from it
        # It reads from descriptor 3 and writes to 4.
        shell = f'exec 3<&{ours[0]} 4>&{theirs[1]}; exec "$@"'
        self.process = subprocess.Popen(
            ["bash", "-c", shell, "bash", program, "--headless", "--no-sandbox", "--disable-gpu", "--force-color-profile=srgb", "--hide-scrollbars",
             "--force-device-scale-factor=1", "--window-size=1280,800", f"--user-data-dir={folder}/profile", "--remote-debugging-pipe", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, pass_fds=(ours[0], theirs[1]))
        os.close(ours[0])
        os.close(theirs[1])
        self.to, self.back, self.data, self.count, self.session, self.problems = ours[1], theirs[0], b"", 0, None, []
        page = next(t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        for domain in ("Runtime", "Log", "Page"):
            self.call(domain + ".enable")
        self.call("Page.navigate", url=address)

    def call(self, method, **parameters):
        self.count += 1
        message = {"id": self.count, "method": method, "params": parameters, **({"sessionId": self.session} if self.session else {})}
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            while b"\0" not in self.data:
                if not select.select([self.back], [], [], 30)[0]:
                    raise AssertionError(f"chromium does not answer {method}")
                got = os.read(self.back, 1 << 20)
                if not got:
                    raise AssertionError(f"chromium ended before it answered {method}")
                self.data += got
            text, self.data = self.data.split(b"\0", 1)
            answer = json.loads(text)
            if answer.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded"):
                self.problems.append(text.decode())
            if answer.get("id") == self.count:
                assert "error" not in answer, answer
                return answer["result"]

    def run(self, script):
        return self.call("Runtime.evaluate", expression=script)["result"].get("value")

    def wait_until(self, script, within=40):
        end = time.monotonic() + within
        while not self.run(script):
            assert time.monotonic() < end, (script, self.run("document.body.innerText"))
            time.sleep(0.1)

    def shoot(self, path):
        path.write_bytes(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))
        if os.environ.get("RAYFARM_KEEP_SHOTS"):
            shutil.copy(path, os.environ["RAYFARM_KEEP_SHOTS"])
        return read_png(path)[2]

    def close(self):
        self.call("Browser.close")
        self.process.wait(timeout=20)
        os.close(self.to)
        os.close(self.back)


class Browser(JobTestAlone):
    def find(self, rows, seen):
        """Where a picture stands in another, pixel for pixel."""
        places = []
        for y in range(len(seen) - len(rows) + 1):
            x = seen[y].find(rows[0])
            if x >= 0 and all(seen[y + i][x:x + len(row)] == row for i, row in enumerate(rows)):
                places.append((x // 3, y))
        return places

    def test_chromium_shows_the_picture(self):
        program = shutil.which("chromium")
        if not program:
            self.skip("chromium is not there")
        out = self.folder / "a.png"
        job = LookedAt(1, SCENE, "-o", out, *SIZE, "--processor-time", "0.0001", "--view", "--progress", "none", "--local-nodes", "2")
        browser = Chromium(program, self.folder, f"http://127.0.0.1:{job.page.port}/{job.page.token}/")
        self.addCleanup(browser.process.kill)
        browser.wait_until("state && state.pixels_done > 0.3 * state.pixels_total && shown !== null")
        half = browser.shoot(self.folder / "half.png")
        self.assertIn("ETA", browser.run("document.getElementById('said').textContent"))
        browser.wait_until("hasSeenEnd")
        self.assertEqual(job.wait(), 0)
        _, _, rows = read_png(out)
        # The job and its server are gone; the page has the picture, all of it, and says so.
        seen = browser.shoot(self.folder / "picture.png")
        (x, y), = self.find(rows, seen)
        self.assertIn("The job has ended: all is done", browser.run("document.getElementById('said').textContent"))
        self.assertEqual(browser.run("document.querySelectorAll('#nodes tr').length"), 2)
        self.assertIn("the thesis's 9 would be 270.0 kB", browser.run("document.getElementById('per-pixel').textContent"))
        # Half-way there was a part of it.
        self.assertEqual(half[y][3 * x:3 * x + 600], rows[0])
        self.assertNotEqual(half[y + 149][3 * x:3 * x + 600], rows[149])
        # Two nodes, two hues: 137 degrees is a green, 275 a violet.
        browser.run("document.getElementById('by-node').click()")
        coloured = browser.shoot(self.folder / "by_node.png")
        self.assertEqual(self.find(rows, coloured), [])
        green = violet = 0
        for row, plain in zip(coloured[y:y + 150], rows):
            for i in range(0, 600, 3):
                red, up, blue = (a - b for a, b in zip(row[3 * x + i:3 * x + i + 3], plain[i:i + 3]))
                green += up > red + 40 and up > blue + 40
                violet += blue > up + 40 and red > up + 20
        self.assertGreater(green, 30 * 200)
        self.assertGreater(violet, 30 * 200)
        browser.run("document.getElementById('by-node').click()")
        self.assertEqual(self.find(rows, browser.shoot(self.folder / "again.png")), [(x, y)])
        self.assertEqual(browser.problems, [])
        browser.close()


class FakeTev:
    """Understands what tev does: CreateImage, CloseImage and UpdateImage V3 (tev's Ipc.h)."""

    def __init__(self, takes=True):
        self.images, self.closed, self.problems = {}, [], []
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.thread = threading.Thread(target=self.serve, daemon=True)
        if takes:
            self.thread.start()

    def serve(self):
        connection, _ = self.listener.accept()
        data = b""
        try:
            while True:
                got = connection.recv(1 << 20)
                if not got:
                    break
                data += got
                while len(data) >= 4 and len(data) >= struct.unpack_from("<I", data)[0]:
                    length = struct.unpack_from("<I", data)[0]
                    self.take(data[:length])
                    data = data[length:]
            if data:
                self.problems.append(f"{len(data)} bytes of a packet that did not come")
        except Exception as e:  # the test reads it
            self.problems.append(repr(e))
        connection.close()

    def take(self, packet):
        kind, at = packet[4], 5

        def read(form):
            nonlocal at
            values = struct.unpack_from("<" + form, packet, at)
            at += struct.calcsize("<" + form)
            return values if len(values) > 1 else values[0]

        def text():
            nonlocal at
            end = packet.index(b"\0", at)
            value, at = packet[at:end].decode(), end + 1
            return value
        if kind == 2:
            self.closed.append(text())
            del self.images[self.closed[-1]]
            return
        assert read("B") in (0, 1)
        name = text()
        if kind == 4:
            width, height, channels = read("iii")
            names = [text() for _ in range(channels)]
            assert name not in self.images
            self.images[name] = (width, height, names, [[None] * (width * height) for _ in names])
        elif kind == 6:
            count = read("i")
            names = [text() for _ in range(count)]
            x, y, w, h = read("iiii")
            offsets, strides = read(f"{count}q"), read(f"{count}q")
            width, height, known, planes = self.images[name]
            assert names == known and x >= 0 and y >= 0 and x + w <= width and y + h <= height
            values = struct.unpack_from(f"<{(len(packet) - at) // 4}f", packet, at)
            assert at + 4 * len(values) == len(packet) and len(values) == w * h * count
            for c in range(count):
                for i in range(w * h):
                    planes[c][(y + i // w) * width + x + i % w] = values[offsets[c] + i * strides[c]]
            return
        else:
            raise AssertionError(f"a packet of kind {kind}")
        assert at == len(packet)

    def finish(self):
        self.thread.join(20)
        self.listener.close()


class Display(JobTest):
    def check_image(self, tev, path):
        """What came is what the EXR holds, to the last bit."""
        width, height, names, planes = tev.images[str(path)]
        self.assertEqual(names, ["R", "G", "B"])
        self.assertFalse(any(value is None for plane in planes for value in plane))
        # PFM: rows from the bottom up.
        pfm = self.folder / "seen.pfm"
        rows = [struct.pack(f"<{3 * width}f", *(planes[c][y * width + x] for x in range(width) for c in range(3))) for y in range(height)]
        pfm.write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + b"".join(reversed(rows)))
        same = subprocess.run(["oiiotool", str(path), "--ch", "R,G,B", str(pfm), "--fail", "0", "--hardfail", "0", "--warn", "0", "--diff"],
                              capture_output=True, text=True, timeout=30)
        self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
        self.assertIn("PASS", same.stdout)
        self.assertGreater(len({value for plane in planes for value in plane}), 100)

    def test_tev_gets_the_pixels_of_the_file(self):
        if not shutil.which("oiiotool"):
            self.skip("oiiotool (openimageio-tools) is not there")
        for ranks, form in ((1, "half"), (3, "float")):
            tev, out = FakeTev(), self.folder / f"{form}.exr"
            arguments = ["render", SCENE, "-o", out, "--size", "96x72", "--pixel-format", form, "--display", f"tev://127.0.0.1:{tev.port}", "--progress", "none"]
            result = self.run_alone(*arguments) if ranks == 1 else self.run_farm(ranks, *arguments)
            self.assertEqual(result.code, 0, result.stderr)
            self.assertNotIn("--display", result.stderr)
            tev.finish()
            self.assertEqual(tev.problems, [])
            self.check_image(tev, out)

    def test_of_an_animation_the_last_frames_stay(self):
        tev = FakeTev()
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.#.png", "--frames", "1-7", "--size", "40x30", "--display",
                                f"tev://localhost:{tev.port}/", "-q")
        self.assertEqual(result.code, 0, result.stderr)
        tev.finish()
        self.assertEqual(tev.problems, [])
        self.assertEqual(tev.closed, [str(self.folder / f"a.{i}.png") for i in (1, 2, 3)])
        self.assertEqual(sorted(tev.images), [str(self.folder / f"a.{i}.png") for i in (4, 5, 6, 7)])

    def test_a_viewer_that_is_not_there_or_goes(self):
        with socket.create_server(("127.0.0.1", 0)) as listener:
            port = listener.getsockname()[1]
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--size", "64x48", "--display", f"tev://127.0.0.1:{port}")
        self.assertEqual(result.code, 0, result.stderr)
        self.assertIn(f"--display tev://127.0.0.1:{port}: the viewer can't be reached (Connection refused)", result.stderr)
        # One that takes nothing: its buffers are full, and the job ends without waiting for it.
        deaf = FakeTev(takes=False)
        result = self.run_alone("render", SCENE, "-o", self.folder / "b.exr", "--size", "1200x900", "--display", f"tev://127.0.0.1:{deaf.port}")
        self.assertEqual(result.code, 0, result.stderr)
        self.assertEqual(result.stderr.count("the viewer takes nothing any more"), 1, result.stderr)
        deaf.listener.close()

    def test_addresses_that_are_none(self):
        for address, says in (("127.0.0.1", "is not of the form tev://"), ("tev://", "names no host"), ("tev://h:0", "is no port"),
                              ("tev://h:x", "is no port"), ("tev://[::1]x:5", "is not of the form"), ("tev://no.such.host.invalid", "is not known here")):
            result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--display", address)
            self.assertEqual(result.code, 2, result.stderr)
            self.assertIn(says, result.stderr)


if __name__ == "__main__":
    main()
