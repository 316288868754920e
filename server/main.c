/* main.c - delaunayd: reads the command line and runs the daemon. */
#include "server/commands_json.h"
#include "server/daemon.h"
#include "server/ops/command_line.h"
#include "server/repair/repair.h"
#include "server/system/machine.h"
#include "server/system/notice.h"

enum { FLUSH_MS = 300 }; /* the last messages have so long */

int main(int argc, char **argv)
{
    struct config config;
    machine_open_standard();
    machine_raise_descriptors(); /* the default of --max-clients depends on it */
    config_init(&config);
    switch (command_line_read(&config, argc, argv)) {
    case COMMAND_LINE_ANSWERED:
        return 0;
    case COMMAND_LINE_BAD:
        return 2;
    case COMMAND_LINE_COMMANDS:
        commands_json_print(stdout);
        return 0;
    case COMMAND_LINE_GOOD:
        break;
    }
    machine_return_blocks(config.max_memory);
    int status = config.check != NULL    ? repair_check(config.check)
                 : config.repair != NULL ? repair_run(config.repair)
                                         : daemon_run(&config);
    notice_flush(FLUSH_MS);
    return status;
}
