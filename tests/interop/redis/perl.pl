# A session through Redis.pm (libredis-perl): perl.pl PORT
use strict;
use warnings;
use Redis;

sub is {
    my ($got, $want, $what) = @_;
    die "$what: $got, not $want\n" unless $got eq $want;
}

sub fails {
    my ($why, $what, $do) = @_;
    is(defined eval { $do->(); 1 } ? 'no error' : $@ =~ $why ? 'error' : $@, 'error', $what);
}

my $r = Redis->new(server => "127.0.0.1:$ARGV[0]", password => 'any', name => 'perl', reconnect => 0);
is($r->ping, 'PONG', 'ping');
is(substr($r->add('perl', 0, 0, 1, 1), 0, 19), 'OK first=0 added=2 ', 'add');
is(($r->nearest('perl', 1, 1, 1))[0], '1 1 1 0', 'nearest');
is(join(' ', $r->keys('per[l]')), 'perl', 'keys');
is($r->client_getname, 'perl', 'client_getname');
is($r->expire('perl', 100), 1, 'expire');
is($r->ttl('perl') > 90, 1, 'ttl');
is($r->wait(0, 10), 0, 'wait');
is(scalar(my @time = $r->time), 2, 'time');
is($r->info->{redis_version}, '7.0.0', 'redis_version');
is($r->multi, 'OK', 'multi');
is($r->add('perl_tx', 1, 2), 'QUEUED', 'queued');
fails(qr/EXECABORT there are no transactions/, 'exec', sub { $r->exec });
is($r->ping, 'PONG', 'ping after exec');
is($r->multi . $r->ping . $r->discard, 'OKQUEUEDOK', 'discard');
is($r->exists('perl_tx'), 0, 'nothing was carried out');
fails(qr/no transactions/, 'watch', sub { $r->watch('perl') });
fails(qr/DROP set deletes sets/, 'del', sub { $r->del('perl') });
fails(qr/unknown command 'SET', with args beginning with: 'a' 'b'/, 'set', sub { $r->set('a', 'b') });
is($r->unlink('perl'), 1, 'unlink');
$r->quit;
