"""A session through redis-py (python3-redis): redis_py.py PORT"""

import sys

import redis

r = redis.Redis(port=int(sys.argv[1]), client_name="interop")
assert r.ping() is True
assert r.echo("hello") == b"hello"
assert r.execute_command("ADD", "p", 0, 0, 4, 0, 4, 4, 0, 4, 2, 2).startswith(b"OK first=0 added=5 coincident=0 version=")
assert r.execute_command("TRIANGULATE", "p").startswith(b"OK points=5 ")
assert r.execute_command("LISTS", "p")[0] == b"4 0 1 2 3"
assert r.execute_command("LOCATE", "p", 2, 1) == [b"0 1 4"]
try:
    r.execute_command("GET", "p", 77)
    raise AssertionError("GET of a missing point is no error")
except redis.ResponseError as e:
    assert str(e).startswith("NOPOINT "), e
pipe = r.pipeline(transaction=False)
for i in range(1000):
    pipe.execute_command("NEAREST", "p", i % 5, 0.25)
assert all(len(reply) == 1 for reply in pipe.execute())
# Sets are keys.
assert r.exists("p", "q") == 1 and r.dbsize() == len(r.keys()) >= 1
assert b"p" in set(r.scan_iter(count=3)) and list(r.scan_iter(match="[p]")) == [b"p"]
assert r.type("p") == b"pointset" and r.type("q") == b"none"
assert r.memory_usage("p") > 0 and r.memory_usage("q") is None
assert r.ttl("p") == -1 and r.ttl("q") == -2 and r.expire("p", 1000) and 900 < r.ttl("p") <= 1000 and 900000 < r.pttl("p")
assert not r.expire("q", 1) and r.persist("p") and not r.persist("p")
# The default pipeline is a transaction: it fails with the reason, and no request is carried out.
pipe = r.pipeline()
pipe.execute_command("ADD", "tx", 1, 2)
pipe.execute_command("LOADB", "tx", 1, bytes(16))
try:
    pipe.execute()
    raise AssertionError("a transaction is no error")
except redis.ResponseError as e:
    assert "transaction=False" in str(e) and isinstance(e, redis.exceptions.ExecAbortError), e
assert r.exists("tx") == 0 and r.ping() is True
try:
    with r.pipeline() as pipe:
        pipe.watch("p")
    raise AssertionError("WATCH is no error")
except redis.ResponseError as e:
    assert "no transactions" in str(e), e
info = r.info()
assert info["used_memory"] > 0 and info["db0"]["keys"] == r.dbsize(), info
assert info["protocol"] == 1 and info["commands"] > 1000, info
assert "calls" in r.info("commands")["command_NEAREST"]
me = [c for c in r.client_list() if c["id"] == str(r.client_id())]
assert len(me) == 1 and me[0]["name"] == "interop" and me[0]["role"] == "rw", me
assert r.client_getname() in (b"interop", "interop")
assert r.client_kill_filter(_id="7") == 0
assert set(r.config_get("max-*")) == {"max-clients", "max-points", "max-memory"}
assert r.slowlog_len() >= 0 and isinstance(r.slowlog_get(5), list)
# Requests that libraries send by habit.
assert redis.Redis(port=int(sys.argv[1]), username="default", password="any").ping() is True
assert r.wait(0, 10) == 0 and len(r.time()) == 2 and r.client_info()["multi"] == -1
assert r.pexpire("p", 30000) and 0 < r.pttl("p") <= 30000 and r.expireat("p", 2000000000) and r.execute_command("EXPIRETIME", "p") == 2000000000
assert r.execute_command("EXPIRE", "p", 5, "NX") == 0 and r.persist("p")
assert info["redis_version"] == "7.0.0" and info["role"] == "master" and info["loading"] == 0, info
assert list(r.info("keyspace")) == ["db0"] and r.info("commandstats")["cmdstat_nearest"]["calls"] >= 1000
assert r.execute_command("ROLE")[0] == b"master" and r.object("encoding", "p") == b"pointset"
for wrong, why in ((lambda: r.set("a", "b"), "unknown command 'SET', with args beginning with: 'a' 'b'"), (lambda: r.delete("p"), "DROP set deletes sets")):
    try:
        wrong()
        raise AssertionError("no error")
    except redis.ResponseError as e:
        assert why in str(e), e
assert r.execute_command("CREATE", "q") and r.unlink("p", "q", "none") == 2 and r.execute_command("CREATE", "p")
assert r.execute_command("DROP", "p") in (b"OK", True)
assert len(r.execute_command("COMMAND")) > 20
r.close()
