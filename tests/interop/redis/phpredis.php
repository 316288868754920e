<?php
// A session through phpredis (php-redis): phpredis.php PORT

function is($got, $want, $what)
{
    if ($got !== $want) {
        fwrite(STDERR, "$what: " . json_encode($got) . ', not ' . json_encode($want) . "\n");
        exit(1);
    }
}

// phpredis throws some errors, and answers others with false.
function fails($r, $do, $why, $what)
{
    try {
        $r->clearLastError();
        is($do(), false, $what);
        $got = (string)$r->getLastError();
    } catch (RedisException $e) {
        $got = $e->getMessage();
    }
    is(str_contains($got, $why) ? $why : $got, $why, $what);
}

$r = new Redis();
$r->connect('127.0.0.1', (int)$argv[1], 2.0, null, 0, 2.0);
is($r->auth('any'), true, 'auth');
is($r->auth(['default', 'any']), true, 'auth of a user');
is($r->ping(), true, 'ping');
is($r->rawCommand('CREATE', 'php'), true, 'create');
is(str_starts_with((string)$r->rawCommand('STAT', 'php'), 'OK') || $r->getLastError() === null, true, 'stat');
is($r->exists('php', 'none'), 1, 'exists');
is($r->keys('ph[p]'), ['php'], 'keys');
is($r->ttl('php'), -1, 'ttl');
is($r->expire('php', 100), true, 'expire');
is($r->pexpire('php', 90000), true, 'pexpire');
is($r->expireAt('php', time() + 50), true, 'expireAt');
is($r->ttl('php') > 40 && $r->ttl('php') <= 50, true, 'ttl after expireAt');
is($r->persist('php'), true, 'persist');
is(abs((int)$r->time()[0] - time()) < 5, true, 'time');
is($r->wait(0, 100), 0, 'wait');
is($r->info()['redis_version'], '7.0.0', 'redis_version');
is(str_starts_with($r->info('keyspace')['db0'], 'keys='), true, 'keyspace');
is(array_keys($r->config('GET', 'max-points')), ['max-points'], 'config');
is($r->role()[0], 'master', 'role');

// What is queued is never carried out, and the connection remains usable.
is($r->multi() === $r, true, 'multi');
$r->rawCommand('CREATE', 'php_tx');
is($r->discard(), true, 'discard');
is($r->ping(), true, 'ping after discard');
is($r->exists('php_tx'), 0, 'nothing was carried out');
fails($r, fn() => $r->watch('php'), 'no transactions', 'watch');
is($r->unwatch(), true, 'unwatch');
is($r->pipeline()->ping()->exists('php')->exec(), [true, 1], 'pipeline');

fails($r, fn() => $r->del('php'), 'DROP set deletes sets', 'del');
is($r->unlink('php', 'none'), 1, 'unlink');
fails($r, fn() => $r->set('a', 'b'), "unknown command 'SET', with args beginning with: 'a' 'b'", 'set');
is($r->ping(), true, 'ping at the end');
