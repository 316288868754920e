"""A new command has its methods, types and subcommand when the parts of the clients are generated again."""

import sys
import unittest
from pathlib import Path

GENERATE = Path(__file__).resolve().parent.parent.parent / "generate"
sys.path.insert(0, str(GENERATE))

import command_line  # noqa: E402
import documents  # noqa: E402
import node  # noqa: E402
import python  # noqa: E402
import table  # noqa: E402


def command(usage, help, **others):
    row = {"name": usage.split()[0], "usage": usage, "help": help, "role": "ro", "about": "set", "changes": False, "body": False}
    return table.Command({**row, **others})


READS = command("SPAN set x y [k] [METHOD slow|fast] [CW]", "how far the k points at x y lie apart", rows="id")
CHANGES = command("FJOIN set field id [id ...] [WITHIN x0 y0 x1 y1]", "joins a value", role="rw", changes=True, result="joined:i")


class Generated(unittest.TestCase):
    def test_methods_for_python(self):
        text = python.generate([READS, CHANGES], set(), "")
        compile(text, "_table.py", "exec")
        self.assertIn('b"SPAN".split()', text)
        self.assertIn(
            "    def span(self, name: str, x: float, y: float, k: Optional[int] = None, method: Optional[str] = None, clockwise: bool = False)"
            ' -> List[Tuple[Any, ...]]:\n        """How far the k points at x y lie apart."""\n        return self._ask(protocol.table("id"), "SPAN",'
            ' set_name(name), real(x), real(y), *option(None, k, whole), *option("METHOD", method, word), *flag("CW", clockwise))\n',
            text,
        )
        self.assertIn(
            "    def join_field(self, name: str, field: str, ids: Iterable[int], within: Optional[Sequence[float]] = None) -> int:\n"
            '        """Joins a value. Returns `joined`."""\n        return self._ask(protocol.fact("joined", int), "FJOIN", set_name(name),'
            ' field_name(field), *each(ids, whole), *option("WITHIN", within, lambda all: each(all, real)))\n',
            text,
        )
        self.assertNotIn("def span(", python.generate([READS], {"span"}, ""))
        options = command("SPAN set name [INTO set] [AT x y] [LIKE pattern]", "x")
        compile(python.generate([options], set(), ""), "_table.py", "exec")
        self.assertIn(
            "name: str, other: str, into: Optional[str] = None, at: Optional[Sequence[float]] = None, like: Optional[str] = None)",
            python.generate([options], set(), ""),
        )

    def test_a_value_of_an_unknown_kind_is_an_error(self):
        with self.assertRaisesRegex(SystemExit, "a value `something`"):
            python.generate([command("SPAN set something", "x")], set(), "")

    def test_methods_for_node(self):
        text = node.generate([READS, CHANGES], set(), "")
        self.assertIn(
            "  async span(set, x, y, k, { method, clockwise, ...options } = {}) {\n    return table('id')(await this._ask(['SPAN',"
            " checkSet(set), real(x), real(y), option([], k, whole), option('METHOD', method, word), flag('CW', clockwise)], options));\n  }\n",
            text,
        )
        self.assertIn("return number('joined')(await this._ask(['FJOIN', checkSet(set), checkField(field), list(ids, whole), ", text)
        types = node.generate_types([READS, CHANGES], set(), "")
        self.assertIn(
            "  span(set: string, x: number, y: number, k?: number, options?: RequestOptions & { method?: 'slow' | 'fast'; clockwise?: boolean }):"
            " Promise<(string | number)[][]>;\n",
            types,
        )
        self.assertIn("joinField(set: string, field: string, ids: Iterable<number>, options?: RequestOptions & { within?: ", types)

    def test_subcommands(self):
        row = command_line.generate([READS], set(), "")
        self.assertIn('{"span", NULL, false, true, "span SET X Y [K] [METHOD slow|fast] [CW]",\n', row)
        self.assertIn(' "How far the K points at X Y lie apart.\\n", NULL, false, "METHOD slow fast CW"},\n', row)

    def test_usages_that_are_more_than_a_list_of_values_get_no_method(self):
        for usage in ("SPAN set x | SPAN set id", "SPAN set [a [b]]", "SPAN set FIELDS a,b", "SPAN set x y [x y ...]"):
            self.assertNotIn("def span(", python.generate([command(usage, "x")], set(), ""), usage)
        self.assertNotIn("def span(", python.generate([command("SPAN set n", "x", body=True)], set(), ""))

    def test_documents_are_compared_with_the_usage(self):
        self.assertEqual(list(documents.faults_of_headings("### SPAN set x y [k] [METHOD slow|fast]\n### SPAN set [CW]\n", [READS])), [])
        self.assertEqual(list(documents.faults_of_headings("", [READS])), ["proto/PROTOCOL.md: there is no section about SPAN"])
        faults = list(documents.faults_of_headings("### SPAN set x y r\n### GONE\n", [READS]))
        self.assertEqual([fault.split(": ")[-1] for fault in faults], "CW METHOD k r slow|fast".split() + ["there is no command GONE"])
        self.assertEqual(list(documents.faults_of_page("p", ".BR SPAN ,\n.B SPAN CW\n.B HOME\n", [READS])), [])
        self.assertEqual(list(documents.faults_of_page("p", '.B "SPAN SLOWLY"\n', [READS])), ["p: SPAN SLOWLY: SLOWLY"])


if __name__ == "__main__":
    unittest.main()
