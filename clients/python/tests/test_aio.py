"""The client for asyncio."""

import ast
import asyncio
import inspect
import tempfile
import unittest
from pathlib import Path

import delaunayd
from delaunayd import ConnectionLost, Refused, _commands, aio

from .common import WithDaemon, end_daemon, start_daemon


class Asyncio(WithDaemon):
    def run_with(self, work):
        async def main():
            async with aio.Client(self.url, timeout=60) as c:
                await work(c)

        asyncio.run(main())

    def test_a_session(self):
        async def work(c):
            self.assertEqual(await c.load("t", [(0, 0), (4, 0), (4, 4), (0, 4), (2, 2)]), 0)
            self.assertEqual((await c.triangulate("t"))["triangles"], 4)
            self.assertEqual(len(await c.triangles("t")) in (4, 12), True)
            self.assertEqual((await c.locate("t", 2, 1)).where, "inside")
            with self.assertRaises(Refused):
                await c.stat("missing")
            self.assertEqual(await c.sets(), ["t"])

        self.run_with(work)

    def test_each_task_gets_its_own_answers(self):
        async def work(c):
            await c.load("t", [(i, 0.5) for i in range(500)])

            async def ask(k):
                self.assertEqual((await c.nearest("t", k + 0.2, 0.5))[0].id, k)

            await asyncio.gather(*(ask(k) for k in range(500)))

        self.run_with(work)

    def test_a_cancelled_request_leaves_no_answer_behind(self):
        async def work(c):
            await c.load("t", [(i, i * i) for i in range(100000)])
            with self.assertRaises(asyncio.TimeoutError):
                await asyncio.wait_for(c.triangulate("t", "shelling"), 0.001)
            self.assertEqual((await c.stat("t"))["points"], 100000)

        self.run_with(work)

    def test_a_private_daemon(self):
        async def main():
            async with aio.Client("private:") as c:
                await c.ping()

        asyncio.run(main())

    def test_a_lost_connection_is_reported_and_made_again(self):
        async def main():
            turns = iter((b"OK 3\n1\n", b"OK 0 first=7\n"))

            async def serve(reader, writer):
                await reader.readline()
                writer.write(next(turns))
                await writer.drain()
                writer.close()

            server = await asyncio.start_server(serve, "127.0.0.1", 0)
            async with aio.Client("delaunay://127.0.0.1:%d" % server.sockets[0].getsockname()[1]) as c:
                with self.assertRaises(ConnectionLost):
                    await c.hull("t")
                self.assertEqual(await c.add("t", 1, 1), 7)
            with self.assertRaises(ConnectionLost):
                await c.ping()
            server.close()

        asyncio.run(main())


class Tokens(unittest.TestCase):
    def test_tokens_and_unix_sockets(self):
        with tempfile.TemporaryDirectory() as directory:
            path = Path(directory)
            (path / "tokens").write_text("rw sesame/1\n")
            (path / "tokens").chmod(0o600)
            daemon, _ = start_daemon("--unix", path / "s", "--auth-file", path / "tokens")
            self.addCleanup(end_daemon, daemon)
            with delaunayd.Client("unix://:sesame%%2F1@%s" % (path / "s")) as c:
                self.assertEqual(c.sets(), [])

            async def main():
                async with aio.Client("unix://:sesame%%2F1@%s" % (path / "s")) as c:
                    self.assertEqual(await c.sets(), [])
                async with aio.Client("unix://:wrong@%s" % (path / "s")) as c:
                    with self.assertRaises(Refused):
                        await c.sets()

            asyncio.run(main())
            with self.assertRaises(Refused):
                delaunayd.Client("unix://:wrong@%s" % (path / "s"))
            with delaunayd.Client(str(path / "s")) as c:
                with self.assertRaises(Refused):
                    c.sets()


class Documentation(unittest.TestCase):
    def test_the_types_of_aio_are_those_of_the_commands(self):
        def methods(path, kind):
            found = [n for n in ast.parse(path.read_text()).body if isinstance(n, ast.ClassDef)][-1]
            return {
                f.name: (ast.dump(f.args), ast.dump(f.returns))
                for f in found.body
                if isinstance(f, kind) and not f.name.startswith("_") and f.name != "close"
            }

        package = Path(delaunayd.__file__).parent
        want = {}
        for module in ("_commands.py", "_constraints.py", "_table.py"):
            want.update(methods(package / module, ast.FunctionDef))
        self.assertGreater(len(want), 20)
        self.assertEqual(methods(package / "aio.pyi", ast.AsyncFunctionDef), want)

    def test_every_method_is_documented(self):
        from delaunayd import _protocol

        for kind in (delaunayd.Client, delaunayd.Pipeline, delaunayd.Mirror, aio.Client, aio.Mirror, _commands.Commands):
            for name, method in inspect.getmembers(kind, inspect.isfunction):
                if not name.startswith("_"):
                    self.assertTrue(inspect.getdoc(method), "%s.%s" % (kind.__name__, name))
        for name in delaunayd.__all__:
            self.assertTrue(inspect.getdoc(getattr(delaunayd, name)), name)


if __name__ == "__main__":
    unittest.main()
