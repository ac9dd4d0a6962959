"""What `cmake --install` and cpack give to users: a program, its manual, completions, and the renderer as a library."""
import gzip
import os
import pathlib
import re
import shutil
import subprocess

from rayfarm_job import ENVIRONMENT, JobTest, RAYFARM, SOURCE, main

BUILD = pathlib.Path(RAYFARM).parent
SCENE = "share/rayfarm/scenes/sky.yaml"  # its sky is read by the module of image formats
SMALL = ["--size", "80x50", "-q"]


class Installation(JobTest):
    def setUp(self):
        super().setUp()
        self.prefix = self.folder / "prefix"

    def call(self, *command, expect=0, **options):
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=60, **options)
        self.assertEqual(done.returncode, expect, f"{command}\n{done.stdout}{done.stderr}")
        return done.stdout

    def install(self):
        self.call("cmake", "--install", BUILD, "--prefix", self.prefix)
        self.assertEqual([p for p in self.prefix.rglob("*") if not p.exists()], [], "links to nothing")

    def command_names(self):
        names = re.search(r"\nCommands:\n(.*?)\n\n", self.call(RAYFARM, "--help"), re.S).group(1)
        return [n for n in re.findall(r"^  ([a-z]+)", names, re.M) if n != "help"]

    def options(self, command):
        """All options of a command, as its help lists them."""
        lines = re.findall(r"^  (-.*?)(?:  .*)?$", self.call(RAYFARM, command, "--help"), re.M)
        return {name for line in lines for name in re.findall(r"(?:^|(?<=, ))--?[a-z][a-z-]*", line)}

    def test_it_renders_from_any_place(self):
        self.install()
        rayfarm, scene = self.prefix / "bin/rayfarm", self.prefix / SCENE
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        self.call(RAYFARM, "render", SOURCE / "scenes/sky.yaml", "-o", self.folder / "built.png", *SMALL)
        self.call(rayfarm, "render", scene, "-o", "alone.png", *SMALL, cwd=elsewhere)
        environment = {key: value for key, value in ENVIRONMENT.items() if not key.startswith("OMPI_")}
        self.call("bash", "-c", '. "$0" && mpirun -n 3 "$@"', self.prefix / "share/rayfarm/mpi-env", rayfarm, "render", scene, "-o",
                  "farm.png", *SMALL, cwd=elsewhere, env=environment)
        for name in ("alone.png", "farm.png"):
            self.assertEqual((elsewhere / name).read_bytes(), (self.folder / "built.png").read_bytes(), name)

    def test_every_scene_is_whole(self):
        """What a scene names is installed, too."""
        self.install()
        scenes = sorted((self.prefix / "share/rayfarm/scenes").rglob("*.yaml"))
        self.assertEqual(len(scenes), len(list((SOURCE / "scenes").rglob("*.yaml"))))
        named = 0
        for scene in scenes:
            for line in re.findall(r"\b(?:file|ies|image|bump): *([^ ,}#]+\.[a-z]+)", scene.read_text()):
                self.assertTrue((scene.parent / line).exists(), f"{scene} names {line}")
                named += 1
            for schema in re.findall(r"\$schema=(\S+)", scene.read_text()):
                self.assertTrue((scene.parent / schema).exists(), f"{scene} names {schema}")
        self.assertGreaterEqual(named, 15)

    def test_the_manual_tells_what_help_tells(self):
        self.install()
        pages = self.prefix / "share/man/man1"
        commands = self.command_names()
        self.assertGreaterEqual(len(commands), 10)
        self.assertEqual(sorted(p.name for p in pages.iterdir()),
                         sorted(["rayfarm.1.gz"] + [f"rayfarm-{command}.1.gz" for command in commands]))
        for command in commands:
            page = gzip.decompress((pages / f"rayfarm-{command}.1.gz").read_bytes()).decode()
            heads = re.findall(r"^\.TP\n(\\fB\\-.*)$", page, re.M)
            told = {name.replace("\\-", "-") for head in heads for name in re.findall(r"\\fB((?:\\-){1,2}[a-z][a-z\\-]*)\\fR", head)}
            self.assertEqual(told, self.options(command), command)
            self.assertIn("--help", told)
        for page in pages.iterdir():
            text = self.write("page.1", gzip.decompress(page.read_bytes()).decode())
            if shutil.which("mandoc"):
                said = self.call("mandoc", "-Tlint", "-Wwarning", text, expect=2)  # the date: pages are the same on any day
                self.assertEqual([line for line in said.splitlines() if "missing date" not in line], [], page)
            if shutil.which("man") and shutil.which("groff"):
                done = subprocess.run(["man", "--warnings", "-l", text], capture_output=True, text=True, timeout=60,
                                      env={**os.environ, "MANWIDTH": "80", "LC_ALL": "C.UTF-8", "MAN_KEEP_FORMATTING": ""})
                self.assertEqual((done.returncode, done.stderr), (0, ""), page)
                self.assertIn("SYNOPSIS", done.stdout)

    def complete(self, *words):
        """What bash completes in the place of the last word."""
        script = self.prefix / "share/bash-completion/completions/rayfarm"
        program = '. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _rayfarm; printf "%s\\n" "${COMPREPLY[@]}"'
        return self.call("bash", "-c", program, script, *words, cwd=self.folder).split()

    def test_bash_completes(self):
        self.install()
        self.write("shot.yaml", "")
        self.assertEqual(self.complete("rayfarm", "rend"), ["render"])
        self.assertEqual(self.complete("rayfarm", "render", "--lig"), ["--lighting", "--light-buffer"])
        self.assertIn("torrance-sparrow", self.complete("rayfarm", "render", "--lighting", ""))
        self.assertEqual(self.complete("rayfarm", "render", "--lighting", "=", "pa"), ["path"])
        self.assertEqual(self.complete("rayfarm", "render", "--lighting", "="), self.complete("rayfarm", "render", "--lighting", ""))
        self.assertEqual(self.complete("rayfarm", "render", "sh"), ["shot.yaml"])
        self.assertEqual(self.complete("rayfarm", "render", "--stats", "sh"), ["shot.yaml"])
        self.assertEqual(self.complete("rayfarm", "render", "--samples", ""), [])
        self.assertEqual(self.complete("rayfarm", "experiment", "samp"), ["sampling"])
        self.assertEqual(self.complete("rayfarm", "experiment", "-o", "p"), ["prefix"])
        for command in self.command_names():
            self.assertEqual(set(self.complete("rayfarm", command, "-")), self.options(command), command)

    def test_fish_completes(self):
        if not shutil.which("fish"):
            self.skip("fish is not installed")
        self.install()
        script = self.prefix / "share/fish/vendor_completions.d/rayfarm.fish"
        self.write("shot.yaml", "")

        def complete(line):
            words = self.call("fish", "--no-config", "-c", f"source {script}; complete -C '{line}'", cwd=self.folder,
                              env={**os.environ, "HOME": str(self.folder)})
            return [word.split("\t")[0] for word in words.splitlines()]

        self.assertEqual(complete("rayfarm rend"), ["render"])
        self.assertEqual(sorted(complete("rayfarm render --lig")), ["--light-buffer", "--lighting"])
        self.assertEqual(complete("rayfarm render --lighting pa"), ["path"])
        self.assertEqual(complete("rayfarm render sh"), ["shot.yaml"])
        self.assertEqual(complete("rayfarm experiment samp"), ["sampling"])

    def test_zsh_completes(self):
        if not shutil.which("zsh"):
            self.skip("zsh is not installed")
        self.install()
        self.write("shot.yaml", "")
        functions = self.prefix / "share/zsh/site-functions"
        # A terminal of its own, in which the tabulator is pressed as people do.
        program = """
          zmodload zsh/zpty
          zpty -b shell zsh -f -i
          zpty -w shell "PS1=; fpath=($1 \\$fpath); autoload -Uz compinit; compinit -u -D; setopt no_beep; print rea''dy"
          zpty -r shell text '*ready*'
          zpty -w -n shell "$2"$'\\t'
          zpty -r shell text "*$3*"  # waits for it
          zpty -d shell
        """
        for typed, expected in (("rayfarm rend", "rayfarm render "), ("rayfarm render --lighti", "rayfarm render --lighting="),
                                ("rayfarm render --lighting=pa", "rayfarm render --lighting=path "),
                                ("rayfarm render sh", "rayfarm render shot.yaml "), ("rayfarm experiment samp", "rayfarm experiment sampling ")):
            self.call("zsh", "-f", "-c", program, "zsh", functions, typed, expected, cwd=self.folder,
                      env={**os.environ, "HOME": str(self.folder), "TERM": "dumb"})

    def test_headers_of_the_library_are_whole(self):
        """What an installed header includes is installed, too, or belongs to fmt, GLM, Imath or the standard library."""
        self.install()
        root = self.prefix / "include/rayfarm"
        headers = list(root.rglob("*.h"))
        self.assertGreater(len(headers), 100)
        for header in headers:
            text = header.read_text()
            for name in re.findall(r'#include "(.*)"', text):
                self.assertTrue((root / name).exists(), f"{header} includes {name}")
            for name in re.findall(r"#include <(.*/.*)>", text):
                self.assertIn(name.split("/")[0], ("fmt", "glm", "Imath"), header)

    def test_the_library_renders_what_the_program_renders(self):
        self.install()
        example = self.folder / "example"
        self.call("cmake", "-S", SOURCE / "tests/library", "-B", example, f"-DCMAKE_PREFIX_PATH={self.prefix}",
                  "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror")
        self.call("cmake", "--build", example)
        ours, theirs = self.folder / "ours.exr", self.folder / "theirs.exr"
        self.call(example / "render_scene", self.prefix / SCENE, theirs, 80, 50, cwd="/")
        self.call(RAYFARM, "render", self.prefix / SCENE, "-o", ours, *SMALL)
        self.assertIn("0 of 4000 pixels differ", self.call(RAYFARM, "compare", ours, theirs))
        said = subprocess.run([example / "render_scene", self.folder / "none.yaml", theirs, "80", "50"], capture_output=True, text=True)
        self.assertEqual(said.returncode, 1)
        self.assertIn("none.yaml: no such file", said.stderr)

    def test_packages_hold_what_belongs_to_them(self):
        for tool in ("dpkg-shlibdeps", "file"):
            if not shutil.which(tool):
                self.skip(f"{tool} is not installed")
        self.call("cpack", "-G", "DEB", "--config", BUILD / "CPackConfig.cmake", "-B", self.folder / "packages")
        packages = {p.name.split("_")[0]: p for p in (self.folder / "packages").glob("*.deb")}
        self.assertEqual(sorted(packages), ["librayfarm-dev", "rayfarm"])
        listed = {name: {line.split()[5] for line in self.call("dpkg-deb", "-c", file).splitlines()} for name, file in packages.items()}
        for path in ("bin/rayfarm", "lib/rayfarm/rayfarm_image_formats.so", "share/rayfarm/mpi-env", "share/rayfarm/scenes/marina.yaml",
                     "share/rayfarm/rayfarm.schema.json", "share/man/man1/rayfarm-render.1.gz", "share/bash-completion/completions/rayfarm",
                     "share/zsh/vendor-completions/_rayfarm", "share/fish/vendor_completions.d/rayfarm.fish",
                     "share/doc/rayfarm/copyright", "share/doc/rayfarm/changelog.Debian.gz"):
            self.assertIn(f"./usr/{path}", listed["rayfarm"])
        for path in ("lib/librayfarm.a", "include/rayfarm/rayfarm.h", "include/rayfarm/common/lighting/renderer.h",
                     "lib/cmake/rayfarm/rayfarmConfig.cmake", "share/doc/librayfarm-dev/copyright"):
            self.assertIn(f"./usr/{path}", listed["librayfarm-dev"])
        self.assertEqual({p for p in listed["rayfarm"] & listed["librayfarm-dev"] if not p.endswith("/")}, set())
        depends = self.call("dpkg-deb", "-f", packages["rayfarm"], "Depends")
        for library in ("libopenmpi3", "libopenexr", "libopenimageio", "libc6"):
            self.assertIn(library, depends)
        self.assertEqual(self.call("dpkg-deb", "-f", packages["rayfarm"], "Recommends").strip(), "openmpi-bin")
        if shutil.which("lintian"):
            self.call("lintian", "--allow-root", "--fail-on", "error", *packages.values())


if __name__ == "__main__":
    main()
