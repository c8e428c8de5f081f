// Counts executed instructions of compiled code where there are no hardware counters: one step after the other, by ptrace.
//
//   stepping OUT COMMAND...
//
// The command stops itself (SIGSTOP) before and after what is to be counted. Written to OUT.counts: "address count" of
// each instruction outside any file's mapping (code that was compiled at run time), between the two stops; to OUT.code:
// for each of them 32 bytes, 16 from its address on and 16 that do nothing, so that a disassembler that reads on from the
// middle of what follows is back in step at the next.
#include <fcntl.h>
#include <sys/ptrace.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <unordered_map>
#include <vector>

constexpr int SLOT = 32, NOP = 0x90;

struct Range {
  uint64_t low, high;
};

std::vector<Range> made_at_run_time(pid_t child) {
  std::ifstream maps("/proc/" + std::to_string(child) + "/maps");
  std::vector<Range> found;
  std::string line;
  while (std::getline(maps, line)) {
    std::istringstream fields(line);
    std::string range, rights, offset, device, node, name;
    fields >> range >> rights >> offset >> device >> node >> name;
    if (rights.find('x') == std::string::npos || !name.empty()) continue;
    Range each{};
    if (std::sscanf(range.c_str(), "%lx-%lx", &each.low, &each.high) == 2) found.push_back(each);
  }
  return found;
}

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string out = argv[1];
  const pid_t child = fork();
  if (child == 0) {
    ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
    execvp(argv[2], argv + 2);
    _exit(127);
  }
  int status = 0;
  int signal = 0;
  while (true) {  // until the first stop that it asks for itself
    if (waitpid(child, &status, 0) < 0 || !WIFSTOPPED(status)) return 3;
    if (WSTOPSIG(status) == SIGSTOP) break;
    signal = WSTOPSIG(status) == SIGTRAP ? 0 : WSTOPSIG(status);
    ptrace(PTRACE_CONT, child, nullptr, reinterpret_cast<void*>(static_cast<long>(signal)));
  }
  const auto ranges = made_at_run_time(child);
  std::unordered_map<uint64_t, uint64_t> counts;
  while (true) {
    if (ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr) != 0) return 4;
    if (waitpid(child, &status, 0) < 0 || !WIFSTOPPED(status)) return 5;
    if (WSTOPSIG(status) == SIGSTOP) break;
    user_regs_struct registers;
    ptrace(PTRACE_GETREGS, child, nullptr, &registers);
    for (const auto& range : ranges)
      if (registers.rip >= range.low && registers.rip < range.high) ++counts[registers.rip];
  }
  const std::map<uint64_t, uint64_t> ordered(counts.begin(), counts.end());
  std::ofstream table(out + ".counts");
  for (const auto& [address, count] : ordered) table << address << ' ' << count << '\n';
  std::ofstream code(out + ".code", std::ios::binary);
  const int memory = open(("/proc/" + std::to_string(child) + "/mem").c_str(), O_RDONLY);
  for (const auto& [address, count] : ordered) {
    char slot[SLOT];
    std::memset(slot, NOP, SLOT);
    if (pread(memory, slot, SLOT / 2, static_cast<off_t>(address)) < 0) return 6;
    code.write(slot, SLOT);
  }
  close(memory);
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
}
