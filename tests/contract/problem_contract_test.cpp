// Tests that the suite of check-problem (study/contract/problem_contract.hpp) finds one planted fault
// of each kind and names it, and that a good problem keeps every promise.
#include "study/contract/problem_contract.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "base/temporary_folder.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A program that answers with the lines of Python in `answer` (the body of a function of x, case and
// seed) after `begin` has run. `more` are further fields of its description.
std::string make_program(const std::string& answer, const std::string& begin = "",
                         const std::string& more = "") {
  return "import json, os, random, sys, time\n" + begin + "\ndef evaluate(x, case, seed):\n" +
         answer +
         R"(
def send(message):
    print(json.dumps(message), flush=True)
for line in sys.stdin:
    m = json.loads(line)
    if m["type"] == "hello":
        d = {"type": "problem", "protocol": 1, "name": "specimen",
             "variables": [{"name": "a", "lower": -5, "upper": 5, "start": 3},
                           {"name": "n", "type": "integer", "lower": 0, "upper": 9},
                           {"name": "kind", "type": "category", "choices": ["round", "steep"]}],
             "objectives": [{"name": "f"}], "cases": {"training": 5}}
)" + more +
         R"(
        send(d)
    elif m["type"] == "quit":
        break
    elif m["type"] == "record":
        send(record(m))
    else:
        seeds = m.get("seeds", m["cases"])
        send({"type": "answers", "id": m["id"],
              "answers": [evaluate(*q) for q in zip(m["points"], m["cases"], seeds)]})
)";
}

constexpr const char* kGood = "    return x[0] ** 2 + x[1] + (x[2] == 'steep') + case\n";

// Runs one check on a program.
ContractFinding check(const std::string& name, const std::string& program) {
  const TemporaryFolder folder;
  std::ofstream(folder / "specimen.py") << program;
  const std::string command = fmt::format(
      "exec:python3 '{}' '{}'", (folder / "specimen.py").string(), folder.path().string());
  const ProblemTrial trial{.load = [&] { return load_problem(command); }};
  const auto found = std::ranges::find(problem_checks(), name, &ProblemCheck::name);
  return run_problem_check(*found, trial);
}

// Expects that the check finds the fault, says `what` and the advice, and that a good program keeps
// the promise.
void expect_broken(const std::string& name, const std::string& program, const std::string& what) {
  const ContractFinding finding = check(name, program);
  EXPECT_EQ(finding.outcome, ContractOutcome::broken) << name;
  EXPECT_THAT(finding.detail, AllOf(HasSubstr(what), HasSubstr(". To do: ")));
}

TEST(ProblemContract, AGoodProblemKeepsEveryPromise) {
  for (const ProblemCheck& one : problem_checks()) {
    const ContractFinding finding = check(one.name, make_program(kGood));
    EXPECT_NE(finding.outcome, ContractOutcome::broken) << one.name << ": " << finding.detail;
  }
}

TEST(ProblemContract, AShippedProblemKeepsEveryPromise) {
  for (const ProblemCheck& one : problem_checks()) {
    const ContractFinding finding =
        run_problem_check(one, {.load = [] { return load_problem("constrained"); }});
    EXPECT_NE(finding.outcome, ContractOutcome::broken) << one.name << ": " << finding.detail;
  }
}

TEST(ProblemContract, FindsADescriptionThatChanges) {
  expect_broken("Description", make_program(kGood, "", "        d['summary'] = str(time.time())\n"),
                "two ways");
}

TEST(ProblemContract, FindsADescriptionThatIsWrong) {
  expect_broken("Description",
                make_program(kGood, "", "        d['variables'][0]['type'] = 'complex'\n"),
                "complex");
}

TEST(ProblemContract, FindsAStartThatFails) {
  expect_broken("Start", make_program("    sys.exit(3) if x[0] == 3 else None\n    return 1\n"),
                "a=3 n=5 kind=round on case 0: the program ended with exit code 3");
}

TEST(ProblemContract, FindsACrashAtABound) {
  expect_broken("Bounds", make_program("    return 1 / x[1]\n"), "n=0");
  expect_broken("Bounds", make_program("    return {'round': 1}[x[2]]\n"), "kind=steep");
}

TEST(ProblemContract, AFailureAtABoundThatIsAnsweredIsNoFault) {
  const ContractFinding finding =
      check("Bounds",
            make_program(
                "    return {'status': 'diverged', 'reason': 'too steep'} if x[1] == 0 else 1\n"));
  EXPECT_EQ(finding.outcome, ContractOutcome::held);
  EXPECT_THAT(finding.detail, HasSubstr("too steep"));
}

TEST(ProblemContract, AnAnswerAgainstTheProtocolEndsTheChecksWithItsOwnAdvice) {
  const ContractFinding finding = check("Start", make_program("    return 'large'\n"));
  EXPECT_EQ(finding.outcome, ContractOutcome::broken);
  EXPECT_TRUE(finding.ends);
  EXPECT_THAT(finding.detail, AllOf(HasSubstr("no object and no number"),
                                    HasSubstr(". To do: correct this answer")));
}

TEST(ProblemContract, ACrashIsShownWithTheLastWordsOfTheProgram) {
  expect_broken("Start", make_program("    sys.exit('no licence')\n"),
                "the program ended with exit code 1; the last that it printed: |  no licence");
}

TEST(ProblemContract, FindsNumbersThatAreNotFinite) {
  expect_broken("Finite", make_program("    return float('nan')\n"),
                "its objective 'f' is not a finite number");
}

TEST(ProblemContract, FindsASetWithoutCases) {
  expect_broken("Sets", make_program("    return 1 / (m['role'] == 'training')\n"),
                "case 0 of validation/1: the program ended with exit code 1");
}

TEST(ProblemContract, FindsAStateThatChangesAnswers) {
  const std::string begin = "count = 0\n";
  const std::string counts = "    global count\n    count += 1\n    return x[0] + count\n";
  expect_broken("Repeatable", make_program(counts, begin), "'f' was");
  expect_broken("Order", make_program(counts, begin), "in another order");
}

TEST(ProblemContract, FindsAnswersThatDependOnTheProcess) {
  expect_broken("Fresh", make_program("    return x[0] + os.getpid()\n"), "started anew");
}

TEST(ProblemContract, FindsAnswersThatDependOnTheBatch) {
  expect_broken("Batch", make_program("    return x[0] + len(m['points'])\n"), "asked alone");
}

TEST(ProblemContract, FindsProcessesThatShareAFile) {
  expect_broken("Parallel",
                make_program("    path = sys.argv[1] + '/shared'\n"
                             "    open(path, 'w').write(str(os.getpid()))\n"
                             "    time.sleep(0.002)\n"
                             "    return float(open(path).read() != str(os.getpid()))\n"),
                "processes at work");
}

TEST(ProblemContract, FindsResidualsThatDoNotAddUp) {
  expect_broken("Residuals",
                make_program("    return {'objectives': [2], 'residuals': [1, 2]}\n", "",
                             "        d['residuals'] = True\n"),
                "squares add up to 5");
}

TEST(ProblemContract, FindsALockThatAKillLeavesBehind) {
  // The lock is made with the first case, because the program is started once to describe itself.
  expect_broken("Kill",
                make_program("    global lock\n"
                             "    if lock is None:\n"
                             "        lock = sys.argv[1] + '/lock'\n"
                             "        os.close(os.open(lock, os.O_CREAT | os.O_EXCL))\n"
                             "        import atexit\n"
                             "        atexit.register(os.remove, lock)\n"
                             "    time.sleep(0.005)\n"
                             "    return x[0]\n",
                             "lock = None\n"),
                "after its process had been killed");
}

TEST(ProblemContract, FindsARecordThatCannotBeRead) {
  expect_broken("Record",
                make_program(kGood,
                             "def record(m):\n    return {'type': 'record', 'id': m['id'], "
                             "'abscissa': {'name': 't', 'unit': 's', 'values': [0, 1]}, "
                             "'series': [{'name': 'v', 'unit': '', 'values': [1]}]}\n",
                             "        d['records'] = True\n"),
                "v");
}

TEST(ProblemContract, TellsHowLongACaseTakes) {
  const ContractFinding finding = check("Time", make_program(kGood));
  EXPECT_EQ(finding.outcome, ContractOutcome::held);
  EXPECT_THAT(finding.detail,
              AllOf(HasSubstr("one case takes "), HasSubstr("armwright computes ")));
}

}  // namespace
}  // namespace armwright
