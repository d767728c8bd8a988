# blueos_services.pl FOLDER [PORT]: answers like the services of BlueOS that the extension asks, at a port of the loopback
# address (any that is free), which it writes to FOLDER/port. GET of sensors and endpoints answers with the files FOLDER/sensors and
# FOLDER/endpoints, or 404; what is posted as an endpoint is appended to FOLDER/posted. FOLDER/asked has a line for each
# request. Ends with the process that started it.
use strict;
use warnings;
use IO::Socket::INET;

my ($folder, $port) = @ARGV;
my $parent = getppid();
$SIG{PIPE} = 'IGNORE';
my $server = IO::Socket::INET->new(Listen => 5, LocalAddr => '127.0.0.1', LocalPort => $port // 0) or die "no port: $!";

sub add {
  my ($name, $text) = @_;
  open(my $file, '>>', "$folder/$name") or die "$name: $!";
  print $file $text;
  close($file);
}

sub text_of {
  my ($name) = @_;
  open(my $file, '<', "$folder/$name") or return undef;
  local $/;
  return scalar <$file>;
}

add('new-port', $server->sockport());
rename("$folder/new-port", "$folder/port");
$server->timeout(1);
while (getppid() == $parent) {
  my $client = $server->accept() or next;
  my $line = <$client> // '';
  my ($method, $path) = split(' ', $line);
  my $length = 0;
  while (defined(my $header = <$client>) && $client->connected()) {
    $length = $1 if $header =~ /^Content-Length: (\d+)/i;
    last if $header =~ /^\r?\n$/;
  }
  my $body = '';
  read($client, $body, $length) if $length;
  add('asked', "$method $path\n");
  my ($status, $answer) = ('404 Not Found', '{"detail": "Not found"}');
  my %files = ('/v1.0/sensors' => 'sensors', '/v1.0/endpoints/' => 'endpoints');
  my $name = $files{$path // ''};
  if (defined $name && $method eq 'GET' && defined text_of($name)) {
    ($status, $answer) = ('200 OK', text_of($name));
  } elsif (defined $name && $name eq 'endpoints' && $method eq 'POST') {
    add('posted', "$body\n");
    ($status, $answer) = ('201 Created', 'null');
  }
  # As uvicorn does, whatever version was asked for.
  print $client "HTTP/1.1 $status\r\nserver: uvicorn\r\ncontent-type: application/json\r\nconnection: close\r\n"
    . "content-length: " . length($answer) . "\r\n\r\n$answer";
  close($client);
}
